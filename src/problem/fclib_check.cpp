#include "fclib_check.h"

#include <cmath>
#include <filesystem>
#include <stdexcept>

namespace frictional_contact_sim
{
namespace
{
/// Deflate packs at most 1032 bytes into one: a dataset larger than so many files has a damaged size.
constexpr size_t LARGEST_DATASET = 1100;

class Checker
{
public:
  explicit Checker(const std::string& path)
    : path_(path), file_(open(path), H5Fclose), largest_(LARGEST_DATASET * std::filesystem::file_size(path))
  {
    if (!file_.valid())
      fail("not readable as HDF5", "an FCLib file");
  }

  [[noreturn]] void fail(const std::string& found, const std::string& expected) const
  {
    throw std::runtime_error(path_ + ": " + found + ", expected " + expected);
  }

  bool exists(const std::string& name) const
  {
    // H5Lexists wants every intermediate group to exist.
    for (size_t slash = name.find('/', 1); slash != std::string::npos; slash = name.find('/', slash + 1))
      if (H5Lexists(file_.id(), name.substr(0, slash).c_str(), H5P_DEFAULT) <= 0)
        return false;
    return H5Lexists(file_.id(), name.c_str(), H5P_DEFAULT) > 0 &&
           H5Oexists_by_name(file_.id(), name.c_str(), H5P_DEFAULT) > 0;
  }

  bool isGroup(const std::string& name) const
  {
    if (!exists(name))
      return false;
    const H5Handle group(H5Gopen2(file_.id(), name.c_str(), H5P_DEFAULT), H5Gclose);
    return group.valid();
  }

  int readInteger(const std::string& name) const
  {
    const std::vector<int> values = readVector<int>(name, H5T_INTEGER, H5T_NATIVE_INT);
    if (values.size() != 1)
      fail(name + " has " + std::to_string(values.size()) + " entries", "1");
    return values[0];
  }
  std::vector<int> readIntegers(const std::string& name) const
  {
    return readVector<int>(name, H5T_INTEGER, H5T_NATIVE_INT);
  }
  std::vector<double> readReals(const std::string& name) const
  {
    return readVector<double>(name, H5T_FLOAT, H5T_NATIVE_DOUBLE);
  }

  void checkReals(const std::string& name, int count) const
  {
    const std::vector<double> values = readReals(name);
    if (values.size() != static_cast<size_t>(count))
      fail(name + " has " + std::to_string(values.size()) + " entries", std::to_string(count));
    for (size_t k = 0; k < values.size(); ++k)
      if (!std::isfinite(values[k]))
        fail(name + "[" + std::to_string(k) + "] is " + std::to_string(values[k]), "a finite number");
  }

  /** Checks a matrix group and returns its content. */
  FclibMatrix readMatrix(const std::string& name) const;
  /** The same, its shape only. */
  std::pair<int, int> checkMatrix(const std::string& name) const
  {
    const FclibMatrix matrix = readMatrix(name);
    return {matrix.rows, matrix.columns};
  }

  /** Empty where there is none. */
  std::string readText(const std::string& name) const
  {
    if (!exists(name))
      return "";
    const H5Handle dataset(H5Dopen2(file_.id(), name.c_str(), H5P_DEFAULT), H5Dclose);
    const H5Handle type(dataset.valid() ? H5Dget_type(dataset.id()) : -1, H5Tclose);
    if (!type.valid() || H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) > 0)
      fail(name + " is not a string of fixed length", "a text");
    const H5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    const hssize_t count = H5Sget_simple_extent_npoints(space.id());
    std::string text(bufferSize(name, count, H5Tget_size(type.id())), '\0');
    if (!text.empty() && H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0)
      fail(name + " cannot be read", "intact data");
    return text.substr(0, text.find('\0'));
  }

private:
  static hid_t open(const std::string& path)
  {
    if (!std::filesystem::exists(path))
      throw std::runtime_error(path + ": no such file, expected an FCLib file (HDF5)");
    if (!std::filesystem::is_regular_file(path) || H5Fis_hdf5(path.c_str()) <= 0)
      throw std::runtime_error(path + ": not an HDF5 file, expected an FCLib file");
    return H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  }

  /** Bytes of a dataset; a damaged file may ask for anything. */
  size_t bufferSize(const std::string& name, hssize_t count, size_t size) const
  {
    if (count < 0 || (size > 0 && static_cast<size_t>(count) > largest_ / size))
      fail(name + " has " + std::to_string(count) + " entries of " + std::to_string(size) + " bytes",
           "at most " + std::to_string(largest_) + " bytes");
    return static_cast<size_t>(count) * size;
  }

  template <typename Number>
  std::vector<Number> readVector(const std::string& name, H5T_class_t wanted, hid_t memory_type) const
  {
    if (!exists(name))
      fail(name + " is missing", "a dataset");
    const H5Handle dataset(H5Dopen2(file_.id(), name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset.valid())
      fail(name + " is not a dataset", "one");
    const H5Handle type(H5Dget_type(dataset.id()), H5Tclose);
    const H5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    if (H5Tget_class(type.id()) != wanted)
      fail(name + " has the wrong type", wanted == H5T_INTEGER ? "integers" : "floating point numbers");
    const hssize_t count = H5Sget_simple_extent_npoints(space.id());
    std::vector<Number> values(bufferSize(name, count, sizeof(Number)) / sizeof(Number));
    if (count > 0 && H5Dread(dataset.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
      fail(name + " cannot be read", "intact data");
    return values;
  }

  std::string path_;
  H5Handle file_;
  size_t largest_;  ///< dataset [bytes]
};

FclibMatrix Checker::readMatrix(const std::string& name) const
{
  if (!isGroup(name))
    fail(name + " is missing", "a matrix group");
  const int rows = readInteger(name + "/m");
  const int columns = readInteger(name + "/n");
  const int nz = readInteger(name + "/nz");
  const int nzmax = readInteger(name + "/nzmax");
  if (rows < 0 || columns < 0 || nzmax < 0 || nz < -2 || nz > nzmax)
    fail(name + " has m = " + std::to_string(rows) + ", n = " + std::to_string(columns) +
             ", nz = " + std::to_string(nz) + ", nzmax = " + std::to_string(nzmax),
         "m, n, nzmax >= 0 and -2 <= nz <= nzmax");
  const std::vector<int> p = readIntegers(name + "/p");
  const std::vector<int> i = readIntegers(name + "/i");
  const std::vector<double> x = readReals(name + "/x");
  const auto pointers = static_cast<size_t>(nz >= 0 ? nz : nz == -1 ? columns + 1 : rows + 1);
  const auto indices = static_cast<size_t>(nz >= 0 ? nz : nzmax);
  if (p.size() != pointers || i.size() != indices)
    fail(name + " has " + std::to_string(p.size()) + " entries in p and " + std::to_string(i.size()) + " in i",
         std::to_string(pointers) + " and " + std::to_string(indices));
  // Dumped triplets may hold fewer values than nzmax; libfclib then reads only as many.
  if (x.size() > static_cast<size_t>(nzmax) || x.size() < indices)
    fail(name + "/x has " + std::to_string(x.size()) + " entries", std::to_string(indices) + " to nzmax");
  const auto expectIndices = [&](const std::vector<int>& values, size_t count, int limit, const char* which)
  {
    for (size_t k = 0; k < count; ++k)
      if (values[k] < 0 || values[k] >= limit)
        fail(name + "/" + which + "[" + std::to_string(k) + "] is " + std::to_string(values[k]),
             "0 to " + std::to_string(limit - 1));
  };
  size_t used = indices;
  if (nz >= 0)
  {
    expectIndices(i, i.size(), rows, "i");
    expectIndices(p, p.size(), columns, "p");
  }
  else
  {
    for (size_t k = 0; k + 1 < p.size(); ++k)
      if (p[k + 1] < p[k])
        fail(name + "/p decreases at entry " + std::to_string(k + 1), "ascending pointers");
    if (p.front() != 0 || p.back() > nzmax)
      fail(name + "/p runs from " + std::to_string(p.front()) + " to " + std::to_string(p.back()),
           "0 to at most nzmax = " + std::to_string(nzmax));
    used = static_cast<size_t>(p.back());
    expectIndices(i, used, nz == -1 ? rows : columns, "i");
  }
  for (size_t k = 0; k < used; ++k)
    if (!std::isfinite(x[k]))
      fail(name + "/x[" + std::to_string(k) + "] is " + std::to_string(x[k]), "a finite number");
  if (exists(name + "/conditioning"))
  {
    checkReals(name + "/conditioning", 1);
    checkReals(name + "/determinant", 1);
    readInteger(name + "/rank");
    readText(name + "/comment");
  }
  return {rows, columns, nz, p, i, x};
}

std::string shapeText(std::pair<int, int> shape)
{
  return std::to_string(shape.first) + " x " + std::to_string(shape.second);
}

void checkGlobal(const Checker& checker, FclibShape& shape)
{
  const auto M = checker.checkMatrix("/fclib_global/M");
  const auto H = checker.checkMatrix("/fclib_global/H");
  shape.velocities = M.first;
  shape.rows = H.second;
  if (M.first != M.second)
    checker.fail("/fclib_global/M is " + shapeText(M), "a square matrix");
  if (H.first != M.first)
    checker.fail("/fclib_global/H is " + shapeText(H), std::to_string(M.first) + " rows as M");
  if (checker.exists("/fclib_global/G"))
  {
    const auto G = checker.checkMatrix("/fclib_global/G");
    shape.bilaterals = G.second;
    if (G.first != M.first)
      checker.fail("/fclib_global/G is " + shapeText(G), std::to_string(M.first) + " rows as M");
    checker.checkReals("/fclib_global/vectors/b", shape.bilaterals);
  }
  checker.checkReals("/fclib_global/vectors/f", shape.velocities);
  checker.checkReals("/fclib_global/vectors/w", shape.rows);
}

void checkLocal(const Checker& checker, FclibShape& shape)
{
  const auto W = checker.checkMatrix("/fclib_local/W");
  shape.rows = W.first;
  if (W.first != W.second)
    checker.fail("/fclib_local/W is " + shapeText(W), "a square matrix");
  if (checker.exists("/fclib_local/V") != checker.exists("/fclib_local/R"))
    checker.fail("only one of /fclib_local/V and /fclib_local/R is there", "both or none");
  if (checker.exists("/fclib_local/R"))
  {
    const auto R = checker.checkMatrix("/fclib_local/R");
    const auto V = checker.checkMatrix("/fclib_local/V");
    shape.bilaterals = R.first;
    if (R.first != R.second || V.first != W.first || V.second != R.first)
      checker.fail("/fclib_local/V is " + shapeText(V) + " and R is " + shapeText(R),
                   "V " + std::to_string(W.first) + " x p and R p x p");
    checker.checkReals("/fclib_local/vectors/s", shape.bilaterals);
  }
  checker.checkReals("/fclib_local/vectors/q", shape.rows);
}

std::mutex& theMutex()
{
  static std::mutex mutex;
  return mutex;
}
}  // namespace

H5Session::H5Session() : lock_(theMutex())
{
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

H5Session::~H5Session()
{
  H5Eset_auto2(H5E_DEFAULT, function_, data_);
}

FclibShape checkFclib(const std::string& path)
{
  const Checker checker(path);
  for (const char* rolling : {"/fclib_global_rolling", "/fclib_local_rolling"})
    if (checker.exists(rolling))
      checker.fail(std::string("a rolling friction problem (") + (rolling + 1) + ")",
                   "fclib_local or fclib_global: there is no rolling law yet");
  FclibShape shape;
  if (checker.isGroup("/fclib_global"))
    shape.kind = FclibKind::GLOBAL;
  else if (!checker.isGroup("/fclib_local"))
    checker.fail("neither the group fclib_local nor fclib_global is there", "one of them");
  const std::string root = shape.kind == FclibKind::GLOBAL ? "/fclib_global" : "/fclib_local";
  shape.dimension = checker.readInteger(root + "/spacedim");
  if (shape.dimension != 2 && shape.dimension != 3)
    checker.fail(root + "/spacedim is " + std::to_string(shape.dimension), "2 or 3");
  if (shape.kind == FclibKind::GLOBAL)
    checkGlobal(checker, shape);
  else
    checkLocal(checker, shape);
  if (shape.rows % shape.dimension != 0)
    checker.fail("there are " + std::to_string(shape.rows) + " contact rows",
                 "a multiple of spacedim = " + std::to_string(shape.dimension));
  checker.checkReals(root + "/vectors/mu", shape.rows / shape.dimension);
  const std::vector<double> mu = checker.readReals(root + "/vectors/mu");
  for (size_t k = 0; k < mu.size(); ++k)
    if (mu[k] < 0.0)
      checker.fail(root + "/vectors/mu[" + std::to_string(k) + "] is " + std::to_string(mu[k]), ">= 0");
  for (const char* text : {"/info/title", "/info/description", "/info/math_info"})
    checker.readText(root + text);
  shape.has_solution = checker.isGroup("/solution");
  if (checker.isGroup("/guesses") && checker.exists("/guesses/number_of_guesses"))
    shape.guesses = checker.readInteger("/guesses/number_of_guesses");
  return shape;
}

FclibMatrix readMatrix(const std::string& path, const std::string& group)
{
  return Checker(path).readMatrix(group);
}

Eigen::VectorXd readNumbers(const std::string& path, const std::string& dataset)
{
  const std::vector<double> values = Checker(path).readReals(dataset);
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

FclibInfo readInfo(const std::string& path, const std::string& root)
{
  const Checker checker(path);
  return {checker.readText(root + "/info/title"), checker.readText(root + "/info/description"),
          checker.readText(root + "/info/math_info")};
}

Solution readSolutionGroup(const std::string& path, const std::string& group, const FclibShape& shape)
{
  const Checker checker(path);
  Solution solution;
  const auto read = [&](const char* name, int count, Eigen::VectorXd& vector)
  {
    const std::string dataset = group + "/" + name;
    if (!checker.exists(dataset))
      return;
    checker.checkReals(dataset, count);
    const std::vector<double> values = checker.readReals(dataset);
    vector = Eigen::Map<const Eigen::VectorXd>(values.data(), count);
  };
  read("v", shape.velocities, solution.v);
  read("u", shape.rows, solution.u);
  read("r", shape.rows, solution.r);
  read("l", shape.bilaterals, solution.lambda);
  return solution;
}

std::vector<LawScale> readScales(const std::string& path, const char* dataset, int count)
{
  const Checker checker(path);
  if (!checker.exists(dataset))
    return {};
  checker.checkReals(dataset, SCALE_NUMBERS * count);
  const std::vector<double> values = checker.readReals(dataset);
  std::vector<LawScale> scales(static_cast<size_t>(count));
  for (size_t i = 0; i < scales.size(); ++i)
  {
    const double* number = values.data() + SCALE_NUMBERS * i;
    if ((number[0] != 0.0 && number[0] != 1.0 && number[0] != 2.0) || !(number[1] > 0.0) || number[2] < 0.0 ||
        number[3] < 0.0)
      checker.fail(std::string(dataset) + " row " + std::to_string(i) + " is " + std::to_string(number[0]) + ", " +
                       std::to_string(number[1]) + ", " + std::to_string(number[2]) + ", " + std::to_string(number[3]),
                   "a unit 0, 1 or 2, a reach > 0, speeds >= 0");
    scales[i] = {static_cast<VelocityUnit>(static_cast<int>(number[0])), number[1], number[2], number[3]};
  }
  return scales;
}

namespace
{
bool writeTable(hid_t file, const char* name, const std::vector<LawScale>& scales)
{
  if (scales.empty())
    return true;
  std::vector<double> numbers;
  for (const LawScale& scale : scales)
    numbers.insert(numbers.end(), {static_cast<double>(scale.unit), scale.reach, scale.speed_change, scale.speed});
  const hsize_t size[2] = {scales.size(), SCALE_NUMBERS};
  const H5Handle space(H5Screate_simple(2, size, nullptr), H5Sclose);
  const H5Handle dataset(H5Dcreate2(file, name, H5T_NATIVE_DOUBLE, space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                         H5Dclose);
  return dataset.valid() &&
         H5Dwrite(dataset.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()) >= 0;
}
}  // namespace

bool writeScales(const std::string& path, const std::vector<LawScale>& laws, const std::vector<LawScale>& bilaterals)
{
  if (laws.empty() && bilaterals.empty())
    return true;
  const H5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  const H5Handle group(H5Gcreate2(file.id(), SCALES_GROUP, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  return group.valid() && writeTable(file.id(), LAW_SCALES, laws) &&
         writeTable(file.id(), BILATERAL_SCALES, bilaterals);
}

}  // namespace frictional_contact_sim
