// What the node takes of rclcpp, with states from standard input and verdicts to standard output.
#pragma once
#include <cstdio>
#include <functional>
#include <memory>
#include <string>

#define RCLCPP_WARN(logger, ...) std::fprintf(stderr, __VA_ARGS__)

namespace rclcpp {

inline void init(int, char **) {}
inline void shutdown() {}

template <typename Message>
struct Publisher {
    using SharedPtr = std::shared_ptr<Publisher>;
    void publish(const Message &message) { written(message); }
};

template <typename Message>
struct Subscription {
    using SharedPtr = std::shared_ptr<Subscription>;
};

class Node {
public:
    explicit Node(const std::string &) {}
    int get_logger() { return 0; }

    template <typename Message>
    typename Publisher<Message>::SharedPtr create_publisher(const std::string &, int)
    {
        return std::make_shared<Publisher<Message>>();
    }

    template <typename Message, typename Callback>
    typename Subscription<Message>::SharedPtr
    create_subscription(const std::string &, int, Callback callback)
    {
        taken = [callback] {
            Message message;
            if (!read(message)) {
                return false;
            }
            callback(message);
            return true;
        };
        return std::make_shared<Subscription<Message>>();
    }

    std::function<bool()> taken;
};

inline void spin(const std::shared_ptr<Node> &node)
{
    while (node->taken()) {
    }
}

} // namespace rclcpp
