//! Ruckig's C++, called without a wrapper in between.

use crate::moves::Move;

/// A number of moves and their trajectories, on the other side.
#[repr(C)]
struct Handle {
    _opaque: [u8; 0],
}

unsafe extern "C" {
    fn canter_bench_new(moves: *const Move, count: usize) -> *mut Handle;
    fn canter_bench_free(bench: *mut Handle);
    fn canter_bench_calculate(bench: *mut Handle, durations: *mut f64);
    fn canter_bench_at(bench: *const Handle, times: *const f64, count: usize, states: *mut f64);
}

/// Ruckig with some moves to calculate.
pub struct Ruckig {
    handle: *mut Handle,
    moves: usize,
}

impl Ruckig {
    /// Takes the moves over into its own form, and calculates each once.
    pub fn new(moves: &[Move]) -> Self {
        // SAFETY: the other side reads `count` moves, which have the same layout there, and keeps
        // none of the pointers.
        let handle = unsafe { canter_bench_new(moves.as_ptr(), moves.len()) };
        Self {
            handle,
            moves: moves.len(),
        }
    }

    /// Calculates every move; `durations` has one place for each, which gets a negative number
    /// where Ruckig refuses.
    pub fn calculate(&mut self, durations: &mut [f64]) {
        assert_eq!(durations.len(), self.moves);
        // SAFETY: the handle lives until drop, and as many durations are written as there are
        // moves, which was checked.
        unsafe { canter_bench_calculate(self.handle, durations.as_mut_ptr()) }
    }

    /// Position, velocity and acceleration of every move at its own times, which stand one move
    /// after the other.
    pub fn at(&self, times: &[f64], states: &mut [[f64; 3]]) {
        assert_eq!(times.len(), states.len());
        assert_eq!(times.len() % self.moves, 0);
        let each = times.len() / self.moves;
        // SAFETY: the handle lives until drop; `each` times are read and states written for each
        // move, which is how many there are.
        unsafe {
            let states = states.as_mut_ptr().cast();
            canter_bench_at(self.handle, times.as_ptr(), each, states);
        }
    }
}

impl Drop for Ruckig {
    fn drop(&mut self) {
        // SAFETY: the handle came from `canter_bench_new` and is not used again.
        unsafe { canter_bench_free(self.handle) }
    }
}
