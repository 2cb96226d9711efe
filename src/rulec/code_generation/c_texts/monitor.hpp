@head@
#ifndef RULEC_MONITOR_HPP
#define RULEC_MONITOR_HPP

#include "@name@.h"

#include <cstdint>
#include <iterator>
#include <type_traits>

namespace rulec_monitor {

using Object = rulec_object;
using Input = rulec_input;
using Verdict = rulec_verdict;
using Range = rulec_range;

/* An object with every value its default, or every value unknown. */
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

/* A world without objects, with every value its default, or every value unknown. */
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

/* The result of a step: its status, and the verdict if the state was accepted. */
struct Step {
    rulec_status status;
    Verdict verdict;
    explicit operator bool() const noexcept { return status == RULEC_OK; }
};

/* A monitor, without heap or exceptions. A copy is independent. */
class Monitor {
public:
    Monitor() noexcept { begin(); }

    /* Forget all earlier states: another drive begins. */
    void begin() noexcept { rulec_init(&state_); }

    /* Takes the next state of the world, with these objects: an array or a vector. */
    template <typename Objects>
    [[nodiscard]] Step step(Input world, const Objects &objects) noexcept
    {
        world.objects = std::data(objects);
        world.n_objects = std::size(objects);
        return step(world);
    }

    /* The same, with the objects of the input. */
    [[nodiscard]] Step step(const Input &world) noexcept
    {
        Step result{};
        result.status = rulec_step(&state_, &world, &result.verdict);
        return result;
    }

    /* The id of the object of a rule's variable (from 0) in the choice of objects with the worst
     * verdict; 0 if the rule has no such variable. */
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
