// Ruckig as a C++ program would use it: one degree of freedom known when compiling, inputs ready in
// memory, so that the times are those of its calculation and not of a wrapper.

#include <cstddef>
#include <vector>

#include <ruckig/ruckig.hpp>

namespace {

using Input = ruckig::InputParameter<1>;
using Trajectory = ruckig::Trajectory<1>;

struct Move {
    double position, velocity, acceleration, target, velocity_limit, acceleration_limit, jerk_limit;
};

struct Bench {
    ruckig::Ruckig<1> ruckig;
    std::vector<Input> inputs;
    Trajectory trajectory;
    std::vector<Trajectory> trajectories;
};

}  // namespace

extern "C" {

// A bench for these moves, each to rest at its target.
Bench* canter_bench_new(const Move* moves, size_t count) {
    auto* bench = new Bench;
    for (size_t at = 0; at < count; ++at) {
        const Move& move = moves[at];
        Input input;
        input.current_position = {move.position};
        input.current_velocity = {move.velocity};
        input.current_acceleration = {move.acceleration};
        input.target_position = {move.target};
        input.max_velocity = {move.velocity_limit};
        input.max_acceleration = {move.acceleration_limit};
        input.max_jerk = {move.jerk_limit};
        bench->inputs.push_back(input);
        Trajectory trajectory;
        bench->ruckig.calculate(input, trajectory);
        bench->trajectories.push_back(trajectory);
    }
    return bench;
}

void canter_bench_free(Bench* bench) { delete bench; }

// Calculates every move and writes its duration, negative where there is an error.
void canter_bench_calculate(Bench* bench, double* durations) {
    for (const Input& input : bench->inputs) {
        const auto result = bench->ruckig.calculate(input, bench->trajectory);
        *durations++ = result == ruckig::Result::Working || result == ruckig::Result::Finished
                           ? bench->trajectory.get_duration()
                           : -1.0;
    }
}

// Position, velocity and acceleration of every move at `count` times of its own.
void canter_bench_at(const Bench* bench, const double* times, size_t count, double* states) {
    for (const Trajectory& trajectory : bench->trajectories) {
        for (size_t at = 0; at < count; ++at) {
            trajectory.at_time(*times++, states[0], states[1], states[2]);
            states += 3;
        }
    }
}

}  // extern "C"
