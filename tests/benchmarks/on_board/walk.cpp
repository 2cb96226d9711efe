// Nanoseconds a step of a walk over an explicit automaton whose edges are labelled with texts, as the
// rule monitor of BARK does it: labels of each agent in a map, edges tried one after the other.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <string>
#include <utility>
#include <vector>

struct Edge {
    std::vector<std::pair<std::string, bool>> labels;
    int target;
    bool kept;
};

#include "edges.h" // std::vector<std::vector<Edge>> edges, and names of the labels

static unsigned int seed = 1;
static unsigned int drawn()
{
    seed ^= seed << 13;
    seed ^= seed >> 17;
    seed ^= seed << 5;
    return seed >> 4;
}

int main(int n_arguments, char **arguments)
{
    const long steps = n_arguments > 1 ? std::atol(arguments[1]) : 20000;
    const int agents = 16, inputs = 64;
    std::vector<unsigned char> given;
    for (std::size_t n = 0; n < inputs * agents * names.size(); n++) {
        given.push_back(drawn() % 2);
    }
    std::vector<int> states(agents, 0);
    unsigned long said = 0;
    timespec from, to;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &from);
    for (long step = 0; step < steps; step++) {
        const unsigned char *at = &given[(step % inputs) * agents * names.size()];
        for (int &state : states) {
            std::map<std::string, bool> labels;
            for (const std::string &name : names) {
                labels[name] = *at++;
            }
            for (const Edge &edge : edges[state]) {
                bool fits = true;
                for (const auto &[name, value] : edge.labels) {
                    fits = fits && labels.at(name) == value;
                }
                if (fits) {
                    state = edge.target;
                    said += edge.kept;
                    break;
                }
            }
        }
    }
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &to);
    const double taken = (to.tv_sec - from.tv_sec) * 1e9 + (to.tv_nsec - from.tv_nsec);
    std::printf("%f %lu\n", taken / steps, said);
}
