// See bench/problems/kuhn_model.h.
#pragma once

#include "bench/problems/kuhn_model.h"
