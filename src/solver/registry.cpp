#include "frictional_contact_sim/solver/registry.h"

#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "frictional_contact_sim/config/nearest_name.h"
#include "frictional_contact_sim/solver/ac_fixed_point.h"
#include "frictional_contact_sim/solver/ac_newton.h"
#include "frictional_contact_sim/solver/admm.h"
#include "frictional_contact_sim/solver/bipotential.h"
#include "frictional_contact_sim/solver/cadoux_broyden.h"
#include "frictional_contact_sim/solver/cadoux_fixed_point.h"
#include "frictional_contact_sim/solver/cadoux_newton.h"
#include "frictional_contact_sim/solver/ds_fixed_point.h"
#include "frictional_contact_sim/solver/ds_newton.h"
#include "frictional_contact_sim/solver/enumeration/enumerate.h"
#include "frictional_contact_sim/solver/fb_bfgs.h"
#include "frictional_contact_sim/solver/fb_levenberg_marquardt.h"
#include "frictional_contact_sim/solver/fb_newton.h"
#include "frictional_contact_sim/solver/fb_newton_smoothed.h"
#include "frictional_contact_sim/solver/gauss_seidel.h"
#include "frictional_contact_sim/solver/haslinger.h"
#include "frictional_contact_sim/solver/interior_point.h"
#include "frictional_contact_sim/solver/lcp_lemke.h"
#include "frictional_contact_sim/solver/option_table.h"
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

template <typename Options>
const std::vector<SolverOption>& options()
{
  return Options::table().options();
}

template <typename Method, typename Options>
std::unique_ptr<Solver> configure(const std::string& name, const SolverOptions& texts)
{
  return std::make_unique<Method>(Options::table().read(name, texts));
}

template <typename Method, typename Options>
SolverEntry entry(const char* name, const char* summary, const char* reference, OperatorUse uses)
{
  return {name, &create<Method>, summary, reference, uses, &options<Options>, &configure<Method, Options>};
}
}  // namespace

const std::vector<SolverEntry>& solverRegistry()
{
  static const std::vector<SolverEntry> registry = {
      entry<Portfolio, PortfolioOptions>("portfolio", "runs methods in turn and keeps the best iterate; the default",
                                         "Acary, Bremond, Huber (2018), conclusions", OperatorUse::BLOCK_ROWS),

      entry<AcNewton, AcNewtonOptions>("ac_newton", "proximal semismooth Newton on the Alart-Curnier function",
                                       "Alart, Curnier (1991); Cadoux (2009), (4.6), appendix D",
                                       OperatorUse::BLOCK_ROWS),
      entry<DsNewton, SemismoothNewtonOptions>(
          "ds_newton", "proximal semismooth Newton on De Saxce's projection function",
          "De Saxce, Feng (1998); Cadoux (2009), (4.8), appendices D.2, E", OperatorUse::BLOCK_ROWS),
      entry<DsFixedPoint, FixedPointOptions>(
          "ds_fixed_point", "projected iterations on De Saxce's formulation, adaptive step length",
          "De Saxce, Feng (1998); Cadoux (2009), (4.8), (4.9)", OperatorUse::PRODUCTS),
      entry<AcFixedPoint, FixedPointOptions>("ac_fixed_point",
                                             "fixed point on Alart and Curnier's formulation, adaptive step length",
                                             "Cadoux (2009), (4.7)", OperatorUse::PRODUCTS),
      entry<FbNewton, SemismoothNewtonOptions>(
          "fb_newton", "proximal semismooth Newton on the Fischer-Burmeister function of the cone",
          "Fukushima, Luo, Tseng (2002); Cadoux (2009), (4.11)", OperatorUse::BLOCK_ROWS),
      entry<FbNewtonSmoothed, FbNewtonSmoothedOptions>(
          "fb_newton_smoothed", "Newton on smoothed Fischer-Burmeister, smoothing driven to zero",
          "Fukushima, Luo, Tseng (2002); Cadoux (2009), 4.2.3", OperatorUse::BLOCK_ROWS),
      entry<FbLevenbergMarquardt, FbLevenbergMarquardtOptions>("fb_levenberg_marquardt",
                                                               "damped Gauss-Newton on the Fischer-Burmeister merit",
                                                               "Cadoux (2009), 4.5.2, (4.14)", OperatorUse::BLOCK_ROWS),
      entry<FbBfgs, FbBfgsOptions>("fb_bfgs",
                                   "limited-memory quasi-Newton on the Fischer-Burmeister merit, Wolfe line search",
                                   "Cadoux (2009), 4.3.2, 4.5.3; Nocedal, Wright (2006)", OperatorUse::PRODUCTS),
      entry<Bipotential, BipotentialOptions>("bipotential",
                                             "minimises De Saxce's bipotential, splitting on the linearised product",
                                             "De Saxce, Feng (1998); Cadoux (2009), 4.3.1, (4.12)", OperatorUse::DENSE),
      entry<GaussSeidel, GaussSeidelOptions>("gauss_seidel", "contact by contact, each solved exactly",
                                             "Jourdan, Alart, Jean (1998); Cadoux (2009), 4.8.2",
                                             OperatorUse::BLOCK_ROWS),
      entry<InteriorPoint, InteriorPointOptions>(
          "interior_point", "Nesterov-Todd scaling, slip speeds changed every iteration",
          "Nesterov, Todd (1997); Acary, Armand, Nguyen, Shpakovych (2022)", OperatorUse::BLOCK_ROWS),
      entry<Admm, AdmmOptions>("admm", "proximal splitting on the law, adaptive spectral penalty",
                               "Boyd et al. (2011); Xu, Figueiredo, Goldstein (2017)", OperatorUse::BLOCK_ROWS),
      entry<Haslinger, HaslingerOptions>("haslinger",
                                         "fixed point on the friction thresholds, Tresca's convex problem inside",
                                         "Haslinger (1983); Cadoux (2009), 4.6, (4.17)", OperatorUse::PRODUCTS),
      entry<CadouxFixedPoint, CadouxOptions>("cadoux_fixed_point",
                                             "fixed point on the slip speeds, convex problem over the cones",
                                             "Cadoux (2009), 4.7, (3.13), (3.24)", OperatorUse::PRODUCTS),
      entry<CadouxNewton, CadouxNewtonOptions>("cadoux_newton",
                                               "Newton on F(s) = s by the linearised KKT system, proximal term",
                                               "Cadoux (2009), 4.7.5, (4.28)", OperatorUse::BLOCK_ROWS),
      entry<CadouxBroyden, CadouxBroydenOptions>("cadoux_broyden", "Broyden's quasi-Newton method on F(s) = s",
                                                 "Broyden (1965); Cadoux (2009), 4.7, table 5.5",
                                                 OperatorUse::PRODUCTS),
      entry<LcpLemke, LcpLemkeOptions>("lcp_lemke",
                                       "Lemke's pivoting, exact in 2D, polyhedral cone with turned facets in 3D",
                                       "Lemke (1965); Stewart, Trinkle (1996); Cadoux (2009), 4.1", OperatorUse::DENSE),
      entry<Enumerate, EnumerateOptions>("enumerate",
                                         "tree search over the modes: a first solution, or the proof that none exists",
                                         "Cadoux (2009), 1.4, 4.7.7, conclusion of part I", OperatorUse::DENSE),
  };
  return registry;
}

const SolverEntry& findSolver(const std::string& name)
{
  std::vector<std::string> valid;
  for (const SolverEntry& entry : solverRegistry())
  {
    if (name == entry.name)
      return entry;
    valid.emplace_back(entry.name);
  }
  throw std::invalid_argument("unknown solver '" + inOneLine(name, 80) + "', " + didYouMean(name, valid) +
                              "expected one of: " + joinNames(valid));
}

std::unique_ptr<Solver> createSolver(const std::string& name, const SolverOptions& options)
{
  return findSolver(name).configure(name, options);
}

void checkSolverOption(const std::string& solver, const std::string& option, const std::string& value)
{
  const std::vector<SolverOption>& options = findSolver(solver).options();
  parseOption(solver, options[findOption(solver, options, option)], value);
}

std::string describeSolvers()
{
  std::ostringstream text;
  text << std::left;
  for (const SolverEntry& entry : solverRegistry())
  {
    text << std::setw(22) << entry.name << ' ' << std::setw(10) << toString(entry.uses) << "  " << entry.summary << " ("
         << entry.reference << ")\n";
    for (const SolverOption& option : entry.options())
      text << "    " << std::setw(20) << option.name << ' ' << std::setw(17) << option.default_value << ' '
           << std::setw(11) << option.unit << ' ' << option.meaning << "; " << option.expected() << '\n';
  }
  return text.str();
}

}  // namespace frictional_contact_sim
