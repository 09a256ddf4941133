// Integer programs as MPS files, by the reader and writer of Clp (separation/integer_program.h).
#include <algorithm>
#include <cmath>
#include <coin/CoinMessageHandler.hpp>
#include <coin/CoinMpsIO.hpp>
#include <coin/CoinPackedMatrix.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>

#include "frictional_contact_sim/separation/integer_program.h"

namespace frictional_contact_sim
{
namespace
{
constexpr double INFINITE = 1e30;  ///< bounds from here on do not bind

/** A reader whose messages go nowhere: it heeds no log level. */
class Mps
{
public:
  Mps() : nowhere_(std::fopen("/dev/null", "w")), handler_(nowhere_)
  {
    io_.passInMessageHandler(&handler_);
    io_.setInfinity(INFINITE);
  }
  ~Mps()
  {
    if (nowhere_ != nullptr)
      std::fclose(nowhere_);
  }
  Mps(const Mps&) = delete;
  Mps& operator=(const Mps&) = delete;
  CoinMpsIO& io() { return io_; }

private:
  FILE* nowhere_;
  CoinMessageHandler handler_;
  CoinMpsIO io_;
};

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

Eigen::MatrixXd matrixOf(const CoinMpsIO& io)
{
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(io.getNumRows(), io.getNumCols());
  const CoinPackedMatrix& columns = *io.getMatrixByCol();
  for (int j = 0; j < io.getNumCols(); ++j)
    for (CoinBigIndex k = columns.getVectorFirst(j); k < columns.getVectorLast(j); ++k)
      A(columns.getIndices()[k], j) += columns.getElements()[k];
  return A;
}
}  // namespace

/** The reader prints a line about it on the standard output, and ignores it. */
void refuseSense(const std::string& path)
{
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line) && line.compare(0, 4, "ROWS") != 0)
    if (line.compare(0, 8, "OBJSENSE") == 0)
      throw std::invalid_argument(path + ": found a section OBJSENSE, expected none: the objective is minimised");
}

IntegerProgram readMps(const std::string& path)
{
  if (!std::filesystem::is_regular_file(path))
    throw std::invalid_argument(path + (std::filesystem::exists(path) ? ": is a folder" : ": no such file") +
                                ", expected an MPS file");
  refuseSense(path);
  Mps mps;
  CoinMpsIO& io = mps.io();
  if (io.readMps(path.c_str(), "") != 0 || io.getNumCols() == 0)
    throw std::invalid_argument(path + ": cannot be read, expected an MPS file with one variable at least");
  IntegerProgram program;
  const int n = io.getNumCols();
  program.name = io.getProblemName();
  program.cost = Eigen::Map<const Eigen::VectorXd>(io.getObjCoefficients(), n);
  program.offset = -io.objectiveOffset();
  for (int j = 0; j < n; ++j)
  {
    program.variables.emplace_back(io.columnName(j));
    program.whole.push_back(io.isInteger(j));
  }
  if (std::count(program.whole.begin(), program.whole.end(), true) == 0)
    throw std::invalid_argument(path + ": has no integer variable, expected one at least");
  if (!program.cost.allFinite())
    throw std::invalid_argument(path + ": an objective coefficient is not finite");
  const Eigen::MatrixXd A = matrixOf(io);
  RowSorter rows(path, n);
  for (int i = 0; i < io.getNumRows(); ++i)
    rows.add(A.row(i).transpose(), io.getRowLower()[i], io.getRowUpper()[i], std::string("row ") + io.rowName(i));
  for (int j = 0; j < n; ++j)
    rows.add(Eigen::VectorXd::Unit(n, j), io.getColLower()[j], io.getColUpper()[j],
             "variable " + program.variables[static_cast<size_t>(j)]);
  program.inequalities = rows.inequalities();
  program.equations = rows.equations();
  return program;
}

void writeMps(const IntegerProgram& program, const std::string& path)
{
  const int n = program.size(), m = program.inequalities.rows() + program.equations.rows();
  const std::vector<double> least(static_cast<size_t>(n), -INFINITE), most(static_cast<size_t>(n), INFINITE);
  std::vector<double> lower, upper;
  CoinPackedMatrix matrix(false, 0.0, 0.0);
  matrix.setDimensions(0, n);
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
      matrix.appendRow(static_cast<int>(columns.size()), columns.data(), values.data());
      lower.push_back(part == &program.equations ? part->b[i] : -INFINITE);
      upper.push_back(part->b[i]);
    }
  std::vector<char> whole(program.whole.begin(), program.whole.end());
  std::vector<std::string> rows;
  for (int i = 0; i < m; ++i)
    rows.push_back("r" + std::to_string(i));
  if (!std::ofstream(path))  // the writer throws what is no std::exception
    throw std::runtime_error("cannot write " + path);
  Mps mps;
  mps.io().setMpsData(matrix, INFINITE, least.data(), most.data(), program.cost.data(), whole.data(), lower.data(),
                      upper.data(), program.variables, rows);
  mps.io().setProblemName(program.name.c_str());
  mps.io().setObjectiveOffset(-program.offset);
  if (mps.io().writeMps(path.c_str(), 0, 1, 1) != 0)
    throw std::runtime_error("cannot write " + path);
}

}  // namespace frictional_contact_sim
