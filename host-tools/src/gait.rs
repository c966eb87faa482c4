//! Gaits: which foot is when on the ground, and where.
