#pragma once

#include "resilin/material/linear_elastic.hpp"
#include "resilin/material/neo_hookean.hpp"
#include "resilin/material/neo_hookean_isochoric.hpp"
#include "resilin/material/neo_hookean_quadratic.hpp"
#include "resilin/material/neo_hookean_simo.hpp"
#include "resilin/material/saint_venant_kirchhoff.hpp"
#include "resilin/material/stable_neo_hookean.hpp"
#include "resilin/material/stable_neo_hookean_log.hpp"

namespace resilin {

template <template <class> class... Law>
struct LawList {
  static constexpr int size = sizeof...(Law);
};

/// Every law. The kernels, the scene reader, the documentation's table and the property tests walk this list.
using Laws = LawList<StableNeoHookean, StableNeoHookeanLog, NeoHookean, NeoHookeanQuadratic,
                     NeoHookeanIsochoric, NeoHookeanSimo, SaintVenantKirchhoff, LinearElastic>;

}  // namespace resilin
