// The files of a rolling contact case.
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "frictional_contact_sim/rolling/closed_forms.h"
#include "frictional_contact_sim/rolling/rolling_case.h"

namespace frictional_contact_sim
{
namespace
{
class File
{
public:
  explicit File(const std::string& path) : path_(path), out_(path)
  {
    if (!out_)
      throw std::invalid_argument(path + ": cannot be written");
    out_.precision(12);
  }
  std::ofstream& stream() { return out_; }
  void close()
  {
    out_.close();
    if (!out_)
      throw std::invalid_argument(path_ + ": could not be written completely");
  }

private:
  std::string path_;
  std::ofstream out_;
};

double lowerModulus(const RollingRun& run)
{
  return run.materials.lower_is_rigid ? RollingCase::RIGID : run.materials.lower.young_modulus;
}

/// Closed form of |q| for the load and motion of a run; exact for beta = 0 only.
double closedTraction(const RollingCase& study, const RollingRun& run, const HertzLine& hertz, double x)
{
  if (run.friction == 0.0)
    return 0.0;
  if (run.steps.size() > 1)
    return mindlinTraction(hertz, run.friction, study.load_shares, x);
  if (study.motion == Motion::STATIC)
    return std::copysign(
        cattaneoTraction(hertz, run.friction, std::abs(run.contact.Q) / (run.friction * run.contact.P), x),
        run.contact.Q);
  return -std::copysign(carterTraction(hertz, study.radius, run.friction, std::abs(study.creepage), x), study.creepage);
}

void writeNodes(std::ostream& out, const RollingCase& study, const std::vector<RollingRun>& runs)
{
  out << "run,friction,lower_modulus,x,width,gap,r_N,r_T,y_N,y_T,u_N,u_T,slip,state,closed_N,closed_T\n";
  for (size_t k = 0; k < runs.size(); ++k)
  {
    const RollingRun& run = runs[k];
    const HertzLine hertz = hertzLine(run.contact.P, study.radius, run.materials.reducedModulus());
    for (Eigen::Index i = 0; i < run.gap.size(); ++i)
    {
      const double x = run.flexibility.x[i];
      const FrictionalContact& c = run.contact;
      out << k << ',' << run.friction << ',' << lowerModulus(run) << ',' << x << ',' << run.flexibility.width[i] << ','
          << run.gap[i] << ',' << c.r_N[i] << ',' << c.r_T[i] << ',' << c.y_N[i] << ',' << c.y_T[i] << ',' << c.u_N[i]
          << ',' << c.u_T[i] << ',' << run.slip[i] << ',' << toString(c.states[static_cast<size_t>(i)]) << ','
          << hertz.pressure(x) << ',' << closedTraction(study, run, hertz, x) << '\n';
    }
  }
}

void writeRuns(std::ostream& out, const RollingCase& study, const std::vector<RollingRun>& runs)
{
  out << "run,friction,lower_modulus,beta,nodes,P,Q,approach,shift,contact_width,stick_width,peak_pressure,hertz_width,"
         "hertz_pressure,energy,asymmetry,residual,pivots,converged,flexibility_seconds,contact_seconds\n";
  for (size_t k = 0; k < runs.size(); ++k)
  {
    const RollingRun& run = runs[k];
    const HertzLine hertz = hertzLine(run.contact.P, study.radius, run.materials.reducedModulus());
    out << k << ',' << run.friction << ',' << lowerModulus(run) << ',' << run.materials.dundursBeta() << ','
        << run.gap.size() << ',' << run.contact.P << ',' << run.contact.Q << ',' << run.approach << ',' << run.shift
        << ',' << run.contactWidth() << ',' << run.stickWidth() << ',' << run.contact.r_N.maxCoeff() << ','
        << 2.0 * hertz.half_width << ',' << hertz.peak_pressure << ',' << run.elasticEnergy() << ',' << run.asymmetry
        << ',' << run.contact.residual << ',' << run.contact.pivots << ',' << run.converged << ','
        << run.flexibility_seconds << ',' << run.contact_seconds << '\n';
  }
}
}  // namespace

std::vector<std::string> writeRollingFiles(const RollingCase& study, const std::vector<RollingRun>& runs,
                                           const std::string& folder)
{
  const std::string stem = folder + "/" + study.name;
  std::vector<std::string> paths = {stem + "_nodes.csv", stem + "_runs.csv"};
  File nodes(paths[0]);
  writeNodes(nodes.stream(), study, runs);
  nodes.close();
  File summary(paths[1]);
  writeRuns(summary.stream(), study, runs);
  summary.close();
  for (size_t k = 0; k < runs.size(); ++k)
    if (runs[k].curve)
    {
      paths.push_back(stem + "_curve_" + std::to_string(k) + ".yaml");
      File curve(paths.back());
      writeCreepCurve(curve.stream(), *runs[k].curve, study.upper, study.radius);
      curve.close();
    }
  for (size_t k = 0; k < runs.size(); ++k)
    if (study.motion == Motion::TRANSIENT || !runs[k].steps.empty())
    {
      paths.push_back(stem + "_history_" + std::to_string(k) + ".csv");
      File history(paths.back());
      const std::vector<LoadStep>& loads = runs[k].steps;
      history.stream() << (loads.empty() ? "step,Q\n" : "step,Q,shift,dissipated\n");
      for (size_t step = 0; step < runs[k].history.size(); ++step)
      {
        history.stream() << step + 1 << ',' << runs[k].history[step];
        if (!loads.empty())
          history.stream() << ',' << loads[step].answer.shift << ',' << loads[step].dissipated;
        history.stream() << '\n';
      }
      history.close();
    }
  return paths;
}

}  // namespace frictional_contact_sim
