// SPDX-License-Identifier: MIT
#pragma once

namespace kissmap {

/// Value that a chi-square variable with `dof` (3 or 6) degrees of freedom stays below with
/// `probability`.
double chi_square_quantile(double probability, int dof);

/// Weight of an edge of squared whitened error `square` under truncated least squares of bound
/// `bound`, smoothed by mu: convex for mu -> 0, exact for mu -> infinity (Yang et al., RA-L 2020,
/// eq. 14).
double graduated_weight(double square, double bound, double mu);

/// The mu at which the cost is still convex for errors up to `max_square`; infinity if none exceeds
/// the bound (same paper, remark 5).
double first_mu(double max_square, double bound);

}  // namespace kissmap
