// A node that receives states of the world and publishes the monitor's verdict after each.

#include "core.hpp"

#include <memory>
#include <rclcpp/rclcpp.hpp>

namespace {

class MonitorNode : public rclcpp::Node {
public:
    MonitorNode() : rclcpp::Node("@name@_monitor")
    {
        publisher_ = create_publisher<Verdict>("verdict", 10);
        subscription_ = create_subscription<State>("state", 10, [this](const State &state) {
            Verdict verdict;
            verdict.header = state.header;
            const auto status = core_.take(state, verdict);
            if (status != RULEC_OK) {
                RCLCPP_WARN(get_logger(), "a state has not been taken: status %d", int(status));
            }
            publisher_->publish(verdict);
        });
    }

private:
    using State = @name@_monitor::msg::State;
    using Verdict = @name@_monitor::msg::Verdict;
    @name@_monitor::Core<State, Verdict> core_;
    rclcpp::Publisher<Verdict>::SharedPtr publisher_;
    rclcpp::Subscription<State>::SharedPtr subscription_;
};

} // namespace

int main(int argc, char **argv)
{
    rclcpp::init(argc, argv);
    rclcpp::spin(std::make_shared<MonitorNode>());
    rclcpp::shutdown();
    return 0;
}
