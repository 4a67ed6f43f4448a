//! Rank 1: smoothing kernels W(r, h). Conventions: q = r/h, support q < 2, grad_i W_ij = F(r) (x_i - x_j) with F = W'(r)/r <= 0.

mod wendland_c2;

pub use wendland_c2::WendlandC2;
