// Points of a disk from Rust. After `make lib`: rustc -L build/lib examples/call.rs -o build/call && build/call
#[link(name = "mcsample", kind = "static")]
extern "C" { fn mcs_disk_sample_n(radius: f32, n: usize, u1: *const f32, u2: *const f32, x: *mut f32, y: *mut f32, pdf: *mut f32); }

fn main() {
    let u = [0.1f32, 0.5, 0.9];
    let (mut x, mut y, mut pdf) = ([0f32; 3], [0f32; 3], [0f32; 3]);
    unsafe { mcs_disk_sample_n(2.0, 3, u.as_ptr(), u.as_ptr(), x.as_mut_ptr(), y.as_mut_ptr(), pdf.as_mut_ptr()); }
    for k in 0..3 {
        println!("{:.6} {:.6} {:.6}", x[k], y[k], pdf[k]);
    }
}
