// Integer programs as MPS files, by Clp (separation/integer_program.h).
#include <coin/Clp_C_Interface.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include "frictional_contact_sim/separation/integer_program.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double INFINITE = 1e30;  ///< Clp's bounds from here on do not bind
constexpr int NAME_LENGTH = 1024;

using ClpModel = std::unique_ptr<Clp_Simplex, void (*)(Clp_Simplex*)>;

void sayNothing(Clp_Simplex*, int, int, const double*, int, const int*, int, char**)
{
}

/** The reader of MPS files heeds no log level. */
ClpModel newModel()
{
  ClpModel model(Clp_newModel(), Clp_deleteModel);
  Clp_setLogLevel(model.get(), 0);
  Clp_registerCallBack(model.get(), sayNothing);
  return model;
}

/** Rows of a file, sorted into inequalities and equations. */
class RowSorter
{
public:
  RowSorter(const std::string& path, Eigen::Index columns) : path_(path), columns_(columns) {}

  void add(const Eigen::VectorXd& row, double lower, double upper, const std::string& what)
  {
    if (!row.allFinite() || std::isnan(lower) || std::isnan(upper) || lower >= INFINITE || upper <= -INFINITE ||
        lower > upper)
      throw std::invalid_argument(path_ + ": " + what + " has bounds " + std::to_string(lower) + " and " +
                                  std::to_string(upper) + ", expected numbers, the first no larger");
    if (lower == upper)
    {
      equations_.push_back({row, upper});
      return;
    }
    if (upper < INFINITE)
      inequalities_.push_back({row, upper});
    if (lower > -INFINITE)
      inequalities_.push_back({-row, -lower});
  }
  Polyhedron inequalities() const { return polyhedron(inequalities_); }
  Polyhedron equations() const { return polyhedron(equations_); }

private:
  using Rows = std::vector<std::pair<Eigen::VectorXd, double>>;

  Polyhedron polyhedron(const Rows& rows) const
  {
    const auto count = static_cast<Eigen::Index>(rows.size());
    Polyhedron result = {Eigen::MatrixXd(count, columns_), Eigen::VectorXd(count)};
    for (Eigen::Index i = 0; i < count; ++i)
    {
      result.A.row(i) = rows[static_cast<size_t>(i)].first.transpose();
      result.b[i] = rows[static_cast<size_t>(i)].second;
    }
    return result;
  }

  std::string path_;
  Eigen::Index columns_;
  Rows inequalities_, equations_;
};

Eigen::MatrixXd matrixOf(Clp_Simplex* clp)
{
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(Clp_numberRows(clp), Clp_numberColumns(clp));
  const CoinBigIndex* starts = Clp_getVectorStarts(clp);
  const int *lengths = Clp_getVectorLengths(clp), *rows = Clp_getIndices(clp);
  const double* values = Clp_getElements(clp);
  for (Eigen::Index j = 0; j < A.cols(); ++j)
    for (CoinBigIndex k = starts[j]; k < starts[j] + lengths[j]; ++k)
      A(rows[k], j) += values[k];
  return A;
}

template <typename Read>
std::string nameOf(const Read& read)
{
  std::vector<char> name(NAME_LENGTH, '\0');
  read(name.data());
  return name.data();
}
}  // namespace

IntegerProgram readMps(const std::string& path)
{
  if (!std::filesystem::is_regular_file(path))
    throw std::invalid_argument(path + (std::filesystem::exists(path) ? ": is a folder" : ": no such file") +
                                ", expected an MPS file");
  const ClpModel model = newModel();
  Clp_Simplex* clp = model.get();
  if (Clp_readMps(clp, path.c_str(), 1, 0) != 0 || Clp_numberColumns(clp) == 0)
    throw std::invalid_argument(path + ": cannot be read, expected an MPS file with one variable at least");
  IntegerProgram program;
  const int n = Clp_numberColumns(clp), m = Clp_numberRows(clp);
  program.name = nameOf([&](char* name) { Clp_problemName(clp, NAME_LENGTH, name); });
  program.maximises = Clp_getObjSense(clp) < 0.0;
  program.cost = (program.maximises ? -1.0 : 1.0) * Eigen::Map<const Eigen::VectorXd>(Clp_getObjCoefficients(clp), n);
  program.offset = -Clp_objectiveOffset(clp);
  const char* whole = Clp_integerInformation(clp);
  for (int j = 0; j < n; ++j)
  {
    program.variables.push_back(nameOf([&](char* name) { Clp_columnName(clp, j, name); }));
    program.whole.push_back(whole != nullptr && whole[j] != 0);
  }
  if (std::count(program.whole.begin(), program.whole.end(), true) == 0)
    throw std::invalid_argument(path + ": has no integer variable, expected one at least");
  if (!program.cost.allFinite())
    throw std::invalid_argument(path + ": an objective coefficient is not finite");
  const Eigen::MatrixXd A = matrixOf(clp);
  RowSorter rows(path, n);
  for (int i = 0; i < m; ++i)
    rows.add(A.row(i).transpose(), Clp_getRowLower(clp)[i], Clp_getRowUpper(clp)[i],
             "row " + nameOf([&](char* name) { Clp_rowName(clp, i, name); }));
  for (int j = 0; j < n; ++j)
    rows.add(Eigen::VectorXd::Unit(n, j), Clp_getColLower(clp)[j], Clp_getColUpper(clp)[j],
             "variable " + program.variables[static_cast<size_t>(j)]);
  program.inequalities = rows.inequalities();
  program.equations = rows.equations();
  return program;
}

void writeMps(const IntegerProgram& program, const std::string& path)
{
  const ClpModel model = newModel();
  Clp_Simplex* clp = model.get();
  const int n = program.size();
  const std::vector<double> lower(static_cast<size_t>(n), -INFINITE), upper(static_cast<size_t>(n), INFINITE);
  const Eigen::VectorXd cost = program.cost;
  const std::vector<int> starts(static_cast<size_t>(n) + 1, 0);
  Clp_addColumns(clp, n, lower.data(), upper.data(), cost.data(), starts.data(), nullptr, nullptr);
  for (const Polyhedron* part : {&program.inequalities, &program.equations})
    for (int i = 0; i < part->rows(); ++i)
    {
      std::vector<int> columns;
      std::vector<double> values;
      for (int j = 0; j < n; ++j)
        if (part->A(i, j) != 0.0)
        {
          columns.push_back(j);
          values.push_back(part->A(i, j));
        }
      const double least = part == &program.equations ? part->b[i] : -INFINITE, most = part->b[i];
      const int ends[2] = {0, static_cast<int>(columns.size())};
      Clp_addRows(clp, 1, &least, &most, ends, columns.data(), values.data());
    }
  std::vector<char> whole(static_cast<size_t>(n), 0);
  for (size_t j = 0; j < whole.size(); ++j)
    whole[j] = program.whole[j] ? 1 : 0;
  Clp_copyInIntegerInformation(clp, whole.data());
  Clp_setObjectiveOffset(clp, -program.offset);
  if (Clp_writeMps(clp, path.c_str(), 1, 1, 1.0) != 0)
    throw std::runtime_error("cannot write " + path);
}

}  // namespace frictional_contact_sim
