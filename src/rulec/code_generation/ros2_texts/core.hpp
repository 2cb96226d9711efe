// Between messages and the monitor in C; it uses nothing of ROS but the messages.

#pragma once

#include "@name@.h"

#include <@name@_monitor/msg/object.hpp>
#include <@name@_monitor/msg/state.hpp>
#include <@name@_monitor/msg/verdict.hpp>
#include <vector>

namespace @name@_monitor {

template <typename State, typename Verdict>
class Core {
public:
    Core() { rulec_init(&monitor_); }

    // The status of the step; if a state is refused, everything is violated at worst.
    rulec_status take(const State &state, Verdict &verdict)
    {
        verdict.best = RULEC_SATISFIED;
        verdict.worst = RULEC_VIOLATED;
        verdict.rules_best.fill(RULEC_SATISFIED);
        verdict.rules_worst.fill(RULEC_VIOLATED);
        rulec_input input;
        rulec_input_unknown(&input);
        objects_.resize(state.objects.size());
        for (std::size_t one = 0; one < objects_.size(); one++) {
            const auto &said = state.objects[one];
            rulec_object_unknown(&objects_[one], said.id, said.type);
            @own@
        }
        input.objects = objects_.data();
        input.n_objects = objects_.size();
        @world@
        rulec_verdict said;
        verdict.status = rulec_step(&monitor_, &input, &said);
        if (verdict.status == RULEC_OK) {
            verdict.best = said.book.best;
            verdict.worst = said.book.worst;
            for (std::size_t rule = 0; rule < RULEC_RULES; rule++) {
                verdict.rules_best[rule] = said.rules[rule].best;
                verdict.rules_worst[rule] = said.rules[rule].worst;
            }
            verdict.violations = said.violations;
            verdict.left_out = said.left_out;
        }
        return verdict.status;
    }

private:
    rulec_state monitor_;
    std::vector<rulec_object> objects_;
};

} // namespace @name@_monitor
