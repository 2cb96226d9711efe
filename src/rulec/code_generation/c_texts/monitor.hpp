#ifndef RULEC_MONITOR_HPP
#define RULEC_MONITOR_HPP

#include "rulec_.h"

#include <cstdint>
#include <iterator>
#include <type_traits>

namespace rulec_monitor {

using Object = rulec_object;
using Input = rulec_input;
using Verdict = rulec_verdict;
using Range = rulec_range;

/* An object of which nothing is said but the defaults, or nothing at all. */
inline Object object(std::uint32_t id, std::uint8_t type) noexcept
{
    Object said;
    rulec_object_defaults(&said, id, type);
    return said;
}

inline Object unknown_object(std::uint32_t id, std::uint8_t type) noexcept
{
    Object said;
    rulec_object_unknown(&said, id, type);
    return said;
}

/* The state of a world without objects, of which nothing is said but the defaults, or nothing. */
inline Input input() noexcept
{
    Input said;
    rulec_input_defaults(&said);
    return said;
}

inline Input unknown_input() noexcept
{
    Input said;
    rulec_input_unknown(&said);
    return said;
}

/* What a step comes to: the verdict, if it has been taken. */
struct Step {
    rulec_status status;
    Verdict verdict;
    explicit operator bool() const noexcept { return status == RULEC_OK; }
};

/* A monitor, without heap or exceptions. A copy goes on by itself. */
class Monitor {
public:
    Monitor() noexcept { begin(); }

    /* Forget all that was before, as where another drive begins. */
    void begin() noexcept { rulec_init(&state_); }

    /* Takes the next state of the world, in which these objects are there: an array or a vector. */
    template <typename Objects>
    [[nodiscard]] Step step(Input world, const Objects &objects) noexcept
    {
        world.objects = std::data(objects);
        world.n_objects = std::size(objects);
        return step(world);
    }

    /* The same, where the input says itself who is there. */
    [[nodiscard]] Step step(const Input &world) noexcept
    {
        Step result{};
        result.status = rulec_step(&state_, &world, &result.verdict);
        return result;
    }

    /* The id of the object that a rule's variable, from 0, stands for where its verdict is the
     * worst; 0 if the rule has no such variable. */
    [[nodiscard]] std::uint32_t about(std::uint32_t rule, std::uint32_t variable) const noexcept
    {
        return rulec_about(&state_, rule, variable);
    }

private:
    rulec_state state_;
};

static_assert(std::is_trivially_copyable<Monitor>::value, "a monitor may be copied as bytes");

} // namespace rulec_monitor

#endif
