//! The promise of `axis` and `node`: whatever frames arrive, in whatever order, lost, doubled or
//! forged, the setpoints keep the limits and never jump; who is gone is noticed; nothing resumes
//! motion by itself. Every tick of every test is held to the first part of it, see `bench`.

/// Here so that the files lie in a folder of their own.
mod axis {
    mod assign;
    mod backlog;
    mod bench;
    mod clock;
    mod commander;
    mod drive;
    mod host;
    mod lateness;
    mod node_bench;
    mod parameters;
    mod planner;
    mod planning;
    mod random;
    mod random_stream;
    mod reaction;
    mod s_curve;
    mod saving;
    mod sequence;
    mod shaping;
    mod stop;
    mod streaming;
    mod streaming_random;
    mod streams;
    mod sync;
    mod target_reached;
    mod telemetry;
    mod three;
    mod trapezoid;
    mod trigger;
    mod troubles;
    mod turns;
    mod watch;
}
