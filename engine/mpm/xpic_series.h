// The grid side of XPIC(m): what PIC damps although the grid can see it.
#pragma once

#include "engine/mpm/block_grid.h"
#include "engine/mpm/grid_transfer.h"
#include "engine/mpm/particles.h"

namespace rend {

/// Replaces NodeVelocity::change by d_2 + ... + d_m with d_1 = v^n and d_{k+1} = (1 - S^+ S) d_k,
/// where S interpolates to particles and S^+ is the mass-weighted transfer back (Hammerquist and
/// Nairn 2017). Held nodes take no part beyond d_1, so that they keep the velocity of their
/// collider. Costs one G2P and one P2G per order above 1.
void add_xpic_series(int order, const GridTransfer& transfer, const Particles& particles, Real dx,
                     BlockGrid& grid);

}  // namespace rend
