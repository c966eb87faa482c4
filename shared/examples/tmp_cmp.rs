//! tmp
use canter_shared::motion::s_curve::*;
use canter_shared::motion::trajectory::*;
use std::io::*;
fn main() {
    // binary rows: kind p0 v0 a0 pf vf vmax vmin amax amin j dur + 3*5 samples
    let mut data = Vec::new();
    stdin().read_to_end(&mut data).unwrap();
    let rows: Vec<f64> = data
        .chunks(8)
        .map(|c| f64::from_le_bytes(c.try_into().unwrap()))
        .collect();
    let mut out = Vec::new();
    for r in rows.chunks(11) {
        let from = Sample {
            position: r[1],
            velocity: r[2],
            acceleration: r[3],
            jerk: 0.0,
        };
        let to = Sample::coasting(r[4], r[5]);
        let b = SignedBounds::new(r[6], r[7], r[8], r[9], r[10]).unwrap();
        let t = if r[0] == 1.0 {
            change_velocity(from, r[5], &b)
        } else if r[0] == 2.0 {
            to_rest(from, r[4], &b)
        } else {
            time_optimal(from, to, &b)
        };
        let t = t.unwrap();
        out.push(t.duration());
        // gaps
        let s = t.segments();
        let mut gap = 0.0f64;
        let mut scale = 0.0f64;
        if let Some(l) = s.last() {
            let g = l.entry.after(l.duration);
            gap = (g.position - r[4]).abs();
            if r[0] == 1.0 {
                gap = 0.0
            }
            let mut gv = (g.velocity - r[5]).abs();
            let mut vs = r[5].abs();
            for q in s {
                scale = scale.max((q.entry.position - r[1]).abs());
                vs = vs.max(q.entry.velocity.abs());
            }
            scale = scale.max((r[4] - r[1]).abs());
            if vs > 0.0 {
                gv /= vs;
            }
            out.push(gap / scale.max(r[1].abs()).max(r[4].abs()).max(1e-300));
            out.push(gv);
        } else {
            out.push(0.0);
            out.push(0.0);
        }
        for i in 0..=4 {
            let x = t.at(t.duration() * i as f64 / 4.0);
            out.extend([x.position, x.velocity, x.acceleration]);
        }
    }
    let bytes: Vec<u8> = out.iter().flat_map(|x| x.to_le_bytes()).collect();
    stdout().write_all(&bytes).unwrap();
}
