#pragma once

namespace resilin {

/// Every law, one on each line: LAW(MyLaw) is the struct MyLaw of material/laws/my_law.hpp. The kernels, the
/// scene reader, the documentation's table and the property tests walk this list; material/CMakeLists.txt
/// reads it and compiles each law by itself.
#define RESILIN_LAWS(LAW)     \
  LAW(StableNeoHookean)       \
  LAW(StableNeoHookeanLog)    \
  LAW(NeoHookean)             \
  LAW(NeoHookeanQuadratic)    \
  LAW(NeoHookeanIsochoric)    \
  LAW(NeoHookeanIsochoricLog) \
  LAW(NeoHookeanSimo)         \
  LAW(SaintVenantKirchhoff)   \
  LAW(LinearElastic)          \
  LAW(CorotatedLinear)        \
  LAW(Corotated)              \
  LAW(Arap)                   \
  LAW(MooneyRivlin)           \
  LAW(Polynomial)             \
  LAW(Yeoh)                   \
  LAW(Ogden)                  \
  LAW(ArrudaBoyce)            \
  LAW(Gent)                   \
  LAW(Hencky)                 \
  LAW(VerondaWestmann)        \
  LAW(HolmesMow)              \
  LAW(HolzapfelGasserOgden)   \
  LAW(ExponentialFibre)       \
  LAW(ToeLinearFibre)         \
  LAW(TransverselyIsotropic)  \
  LAW(Orthotropic)            \
  LAW(FungOrthotropic)        \
  LAW(Guccione)

#define RESILIN_DECLARE_LAW(Law) \
  template <class Real>          \
  struct Law;
RESILIN_LAWS(RESILIN_DECLARE_LAW)
#undef RESILIN_DECLARE_LAW

}  // namespace resilin
