// See bench/problems/lattice_model.h.
#pragma once

#include "bench/problems/lattice_model.h"
