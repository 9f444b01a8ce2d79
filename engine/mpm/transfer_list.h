// The closed list of transfer schemes: to add one, include its file and name it in TransferList.
#pragma once

#include "engine/mpm/transfer_apic.h"
#include "engine/mpm/transfer_flip.h"
#include "engine/mpm/transfer_pic.h"
#include "engine/mpm/transfer_polypic.h"
#include "engine/mpm/transfer_rpic.h"
#include "engine/mpm/transfer_xpic.h"

#include <tuple>

namespace rend {

using TransferList = std::tuple<PicTransfer,      //
                                FlipTransfer,     //
                                ApicTransfer,     //
                                RpicTransfer,     //
                                PolyPicTransfer,  //
                                XpicTransfer>;

/// Calls f(Scheme{}) with the scheme of `type`; returns false when it is not listed.
template <class F>
bool with_transfer(Transfer type, F&& f) {
  return std::apply(
      [&](auto... scheme) { return ((scheme.kType == type && (f(scheme), true)) || ...); },
      TransferList{});
}

}  // namespace rend
