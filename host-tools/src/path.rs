//! Paths: through waypoints of several axes, timed within their limits.
