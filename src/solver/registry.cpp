#include "frictional_contact_sim/solver/registry.h"

#include <stdexcept>

#include "frictional_contact_sim/solver/ac_fixed_point.h"
#include "frictional_contact_sim/solver/ac_newton.h"
#include "frictional_contact_sim/solver/admm.h"
#include "frictional_contact_sim/solver/bipotential.h"
#include "frictional_contact_sim/solver/cadoux_broyden.h"
#include "frictional_contact_sim/solver/cadoux_fixed_point.h"
#include "frictional_contact_sim/solver/cadoux_newton.h"
#include "frictional_contact_sim/solver/ds_fixed_point.h"
#include "frictional_contact_sim/solver/ds_newton.h"
#include "frictional_contact_sim/solver/fb_bfgs.h"
#include "frictional_contact_sim/solver/fb_levenberg_marquardt.h"
#include "frictional_contact_sim/solver/fb_newton.h"
#include "frictional_contact_sim/solver/fb_newton_smoothed.h"
#include "frictional_contact_sim/solver/gauss_seidel.h"
#include "frictional_contact_sim/solver/haslinger.h"
#include "frictional_contact_sim/solver/interior_point.h"
#include "frictional_contact_sim/solver/lcp_lemke.h"
#include "frictional_contact_sim/solver/portfolio.h"

namespace frictional_contact_sim
{
namespace
{
template <typename Method>
std::unique_ptr<Solver> create()
{
  return std::make_unique<Method>();
}
}  // namespace

const std::vector<SolverEntry>& solverRegistry()
{
  static const std::vector<SolverEntry> registry = {
      {"portfolio", &create<Portfolio>, "runs methods in turn and keeps the best iterate; the default",
       "Acary, Bremond, Huber (2018), conclusions", OperatorUse::BLOCK_ROWS},

      {"ac_newton", &create<AcNewton>, "proximal semismooth Newton on the Alart-Curnier function",
       "Alart, Curnier (1991); Cadoux (2009), (4.6), appendix D", OperatorUse::BLOCK_ROWS},
      {"ds_newton", &create<DsNewton>, "proximal semismooth Newton on De Saxce's projection function",
       "De Saxce, Feng (1998); Cadoux (2009), (4.8), appendices D.2, E", OperatorUse::BLOCK_ROWS},
      {"ds_fixed_point", &create<DsFixedPoint>, "projected iterations on De Saxce's formulation, adaptive step length",
       "De Saxce, Feng (1998); Cadoux (2009), (4.8), (4.9)", OperatorUse::PRODUCTS},
      {"ac_fixed_point", &create<AcFixedPoint>, "fixed point on Alart and Curnier's formulation, adaptive step length",
       "Cadoux (2009), (4.7)", OperatorUse::PRODUCTS},
      {"fb_newton", &create<FbNewton>, "proximal semismooth Newton on the Fischer-Burmeister function of the cone",
       "Fukushima, Luo, Tseng (2002); Cadoux (2009), (4.11)", OperatorUse::BLOCK_ROWS},
      {"fb_newton_smoothed", &create<FbNewtonSmoothed>,
       "Newton on smoothed Fischer-Burmeister, smoothing driven to zero",
       "Fukushima, Luo, Tseng (2002); Cadoux (2009), 4.2.3", OperatorUse::BLOCK_ROWS},
      {"fb_levenberg_marquardt", &create<FbLevenbergMarquardt>, "damped Gauss-Newton on the Fischer-Burmeister merit",
       "Cadoux (2009), 4.5.2, (4.14)", OperatorUse::BLOCK_ROWS},
      {"fb_bfgs", &create<FbBfgs>, "limited-memory quasi-Newton on the Fischer-Burmeister merit, Wolfe line search",
       "Cadoux (2009), 4.3.2, 4.5.3; Nocedal, Wright (2006)", OperatorUse::PRODUCTS},
      {"bipotential", &create<Bipotential>, "minimises De Saxce's bipotential, splitting on the linearised product",
       "De Saxce, Feng (1998); Cadoux (2009), 4.3.1, (4.12)", OperatorUse::DENSE},
      {"gauss_seidel", &create<GaussSeidel>, "contact by contact, each solved exactly",
       "Jourdan, Alart, Jean (1998); Cadoux (2009), 4.8.2", OperatorUse::BLOCK_ROWS},
      {"interior_point", &create<InteriorPoint>, "Nesterov-Todd scaling, slip speeds changed every iteration",
       "Nesterov, Todd (1997); Acary, Armand, Nguyen, Shpakovych (2022)", OperatorUse::BLOCK_ROWS},
      {"admm", &create<Admm>, "proximal splitting on the law, adaptive spectral penalty",
       "Boyd et al. (2011); Xu, Figueiredo, Goldstein (2017)", OperatorUse::BLOCK_ROWS},
      {"haslinger", &create<Haslinger>, "fixed point on the friction thresholds, Tresca's convex problem inside",
       "Haslinger (1983); Cadoux (2009), 4.6, (4.17)", OperatorUse::PRODUCTS},
      {"cadoux_fixed_point", &create<CadouxFixedPoint>, "fixed point on the slip speeds, convex problem over the cones",
       "Cadoux (2009), 4.7, (3.13), (3.24)", OperatorUse::PRODUCTS},
      {"cadoux_newton", &create<CadouxNewton>, "Newton on F(s) = s by the linearised KKT system, proximal term",
       "Cadoux (2009), 4.7.5, (4.28)", OperatorUse::BLOCK_ROWS},
      {"cadoux_broyden", &create<CadouxBroyden>, "Broyden's quasi-Newton method on F(s) = s",
       "Broyden (1965); Cadoux (2009), 4.7, table 5.5", OperatorUse::PRODUCTS},
      {"lcp_lemke", &create<LcpLemke>, "Lemke's pivoting, exact in 2D, polyhedral cone with turned facets in 3D",
       "Lemke (1965); Stewart, Trinkle (1996); Cadoux (2009), 4.1", OperatorUse::DENSE},
  };
  return registry;
}

std::unique_ptr<Solver> createSolver(const std::string& name)
{
  std::string valid;
  for (const SolverEntry& entry : solverRegistry())
  {
    if (name == entry.name)
      return entry.create();
    valid += valid.empty() ? "" : ", ";
    valid += entry.name;
  }
  throw std::invalid_argument("unknown solver '" + name + "', expected one of: " + valid);
}

}  // namespace frictional_contact_sim
