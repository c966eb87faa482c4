//! Foot trajectories: one cycle of one leg, stance first, in closed form.
