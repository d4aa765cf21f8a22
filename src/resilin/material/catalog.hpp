#pragma once

#include "resilin/material/laws/arap.hpp"
#include "resilin/material/laws/arruda_boyce.hpp"
#include "resilin/material/laws/corotated.hpp"
#include "resilin/material/laws/corotated_linear.hpp"
#include "resilin/material/laws/gent.hpp"
#include "resilin/material/laws/holzapfel_gasser_ogden.hpp"
#include "resilin/material/laws/linear_elastic.hpp"
#include "resilin/material/laws/mooney_rivlin.hpp"
#include "resilin/material/laws/neo_hookean.hpp"
#include "resilin/material/laws/neo_hookean_isochoric.hpp"
#include "resilin/material/laws/neo_hookean_quadratic.hpp"
#include "resilin/material/laws/neo_hookean_simo.hpp"
#include "resilin/material/laws/ogden.hpp"
#include "resilin/material/laws/saint_venant_kirchhoff.hpp"
#include "resilin/material/laws/stable_neo_hookean.hpp"
#include "resilin/material/laws/stable_neo_hookean_log.hpp"
#include "resilin/material/laws/yeoh.hpp"

namespace resilin {

template <template <class> class... Law>
struct LawList {
  static constexpr int size = sizeof...(Law);
};

/// Whether a law's volume energy stands apart as `volume_energy(j)`. Elements with a mean volume need it.
template <class Law>
constexpr bool has_volume_energy = requires { &Law::template volume_energy<double>; };

/// Every law. The kernels, the scene reader, the documentation's table and the property tests walk this list.
using Laws =
    LawList<StableNeoHookean, StableNeoHookeanLog, NeoHookean, NeoHookeanQuadratic, NeoHookeanIsochoric,
            NeoHookeanSimo, SaintVenantKirchhoff, LinearElastic, CorotatedLinear, Corotated, Arap,
            MooneyRivlin, Yeoh, Ogden, ArrudaBoyce, Gent, HolzapfelGasserOgden>;

}  // namespace resilin
