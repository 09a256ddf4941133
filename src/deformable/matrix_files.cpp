// Matrices of a finite-element program: Matrix Market (Boisvert, Pozo, Remington 1996) and a table of nodes.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "frictional_contact_sim/deformable/elastic_mesh.h"
#include "frictional_contact_sim/model/model_error.h"

namespace frictional_contact_sim
{
namespace
{
[[noreturn]] void fail(const std::string& path, int line, const std::string& found, const std::string& expected)
{
  throw ModelError(path + (line > 0 ? ":" + std::to_string(line) : "") + ": found " + found + ", expected " + expected);
}

std::ifstream openFile(const std::string& path, const std::string& expected)
{
  std::ifstream file(path);
  if (!file)
    fail(path, 0, "no file that can be read", expected);
  return file;
}

/** The whole word as a finite number, in C's notation or Fortran's (2.1D+11). */
bool parseNumber(std::string word, double& value)
{
  std::replace_if(
      word.begin(), word.end(), [](char c) { return c == 'D' || c == 'd'; }, 'e');
  const char* const begin = word.data() + (word.size() > 1 && word[0] == '+' && word[1] != '-' ? 1 : 0);
  const char* const end = word.data() + word.size();
  const std::from_chars_result result = std::from_chars(begin, end, value);
  return result.ec == std::errc() && result.ptr == end && std::isfinite(value);
}

bool parseNumber(const std::string& word, long& value)
{
  const std::from_chars_result result = std::from_chars(word.data(), word.data() + word.size(), value);
  return result.ec == std::errc() && result.ptr == word.data() + word.size();
}

/** Lines of a Matrix Market file, comments left out. */
class MarketFile
{
public:
  explicit MarketFile(const std::string& path) : path_(path), file_(openFile(path, "a Matrix Market file"))
  {
    std::getline(file_, text_);
    std::transform(text_.begin(), text_.end(), text_.begin(), [](unsigned char c) { return std::tolower(c); });
    splitWords();
    if (words_.size() != 5 || words_[0] != "%%matrixmarket" || words_[1] != "matrix" || words_[2] != "coordinate" ||
        (words_[3] != "real" && words_[3] != "integer") || (words_[4] != "symmetric" && words_[4] != "general"))
      fail("%%MatrixMarket matrix coordinate real general or symmetric");
    is_symmetric_ = words_[4] == "symmetric";
  }

  bool isSymmetric() const { return is_symmetric_; }
  const std::vector<std::string>& words() const { return words_; }

  /** The next line that says something, in words. */
  bool next()
  {
    while (std::getline(file_, text_))
    {
      ++line_;
      splitWords();
      if (!words_.empty() && words_[0][0] != '%')
        return true;
    }
    text_.clear();
    words_.clear();
    return false;
  }

  [[noreturn]] void fail(const std::string& expected) const
  {
    frictional_contact_sim::fail(path_, line_, "'" + text_ + "'", expected);
  }

private:
  void splitWords()
  {
    std::istringstream line(text_);
    words_.clear();
    for (std::string word; line >> word;)
      words_.push_back(word);
    if (!text_.empty() && text_.back() == '\r')
      text_.pop_back();
  }

  std::string path_;
  std::ifstream file_;
  std::string text_;
  std::vector<std::string> words_;
  int line_ = 1;
  bool is_symmetric_ = false;
};

/** A symmetric matrix. @param nodes of the table @param rows expected, 0: one to three a node */
SparseRows readMatrixMarket(const std::string& path, long nodes, long rows)
{
  MarketFile file(path);
  long size = 0;
  long columns = 0;
  long count = 0;
  if (!file.next() || file.words().size() != 3 || !parseNumber(file.words()[0], size) ||
      !parseNumber(file.words()[1], columns) || !parseNumber(file.words()[2], count) || count < 0)
    file.fail("rows, columns, entries");
  if (rows == 0 && (size % nodes != 0 || size / nodes < 1 || size / nodes > 3))
    file.fail("1, 2 or 3 rows for each of " + std::to_string(nodes) + " nodes");
  rows = rows == 0 ? size : rows;
  if (size != rows || columns != rows)
    file.fail(std::to_string(rows) + " x " + std::to_string(rows) + ", as the table of nodes and the mass matrix say");
  std::vector<Eigen::Triplet<double>> entries;
  for (long k = 0; k < count; ++k)
  {
    long row = 0;
    long column = 0;
    double value = 0.0;
    if (!file.next())
      fail(path, 0, std::to_string(k) + " entries", std::to_string(count));
    if (file.words().size() != 3 || !parseNumber(file.words()[0], row) || !parseNumber(file.words()[1], column) ||
        !parseNumber(file.words()[2], value) || row < 1 || column < 1 || row > rows || column > rows)
      file.fail("row, column, finite value");
    if (file.isSymmetric() && column > row)
      file.fail("row >= column: of a symmetric matrix the file has the lower triangle alone");
    entries.emplace_back(row - 1, column - 1, value);
    if (file.isSymmetric() && row != column)
      entries.emplace_back(column - 1, row - 1, value);
  }
  if (file.next())
    file.fail("the end of the file after " + std::to_string(count) + " entries");
  SparseRows matrix(rows, rows);
  matrix.setFromTriplets(entries.begin(), entries.end());
  if (matrix.nonZeros() != static_cast<Eigen::Index>(entries.size()))
    fail(path, 0, "an entry that stands there twice", "every entry once");
  const SparseRows transposed = matrix.transpose();
  const double asymmetry = (matrix - transposed).norm();
  if (asymmetry > 1e-9 * matrix.norm())
    fail(path, 0, "a matrix that differs from its transpose by " + std::to_string(asymmetry), "a symmetric one");
  return SparseRows(0.5 * (matrix + transposed));
}

struct NodeTable
{
  std::vector<Eigen::Vector3d> nodes;
  std::vector<int> surface;
  std::vector<int> fixed;
};

NodeTable readNodes(const std::string& path)
{
  std::ifstream file = openFile(path, "a table of nodes");
  std::string text;
  const auto next = [&]
  {
    const bool is_there = static_cast<bool>(std::getline(file, text));
    text.erase(text.find_last_not_of(" \t\r") + 1);
    return is_there;
  };
  const auto cellsOf = [](const std::string& text)
  {
    std::vector<std::string> cells;
    std::istringstream line(text);
    for (std::string cell; std::getline(line, cell, ',');)
    {
      cell.erase(cell.find_last_not_of(" \t") + 1);
      cell.erase(0, cell.find_first_not_of(" \t"));
      cells.push_back(cell);
    }
    return cells;
  };
  static const char* const COLUMNS[] = {"x", "y", "z", "surface", "fixed"};
  next();
  const std::vector<std::string> head = cellsOf(text);
  int place[5];
  for (int k = 0; k < 5; ++k)
  {
    const auto found = std::find(head.begin(), head.end(), COLUMNS[k]);
    place[k] = found == head.end() ? -1 : static_cast<int>(found - head.begin());
    if (k < 3 && place[k] < 0)
      fail(path, 1, "'" + text + "'", "the columns x, y, z and, where wanted, surface and fixed");
  }
  NodeTable table;
  for (int line = 2; next(); ++line)
  {
    const std::vector<std::string> cells = cellsOf(text);
    if (cells.empty())
      continue;
    double values[5] = {0.0, 0.0, 0.0, place[3] < 0 ? 1.0 : 0.0, 0.0};
    for (int k = 0; k < 5; ++k)
    {
      if (place[k] < 0)
        continue;
      if (place[k] >= static_cast<int>(cells.size()) || !parseNumber(cells[place[k]], values[k]))
        fail(path, line, "'" + text + "'", std::string("a number in column ") + COLUMNS[k]);
      if (k >= 3 && values[k] != 0.0 && values[k] != 1.0)
        fail(path, line, "'" + text + "'", std::string("0 or 1 in column ") + COLUMNS[k]);
    }
    if (values[3] == 1.0)
      table.surface.push_back(static_cast<int>(table.nodes.size()));
    if (values[4] == 1.0)
      table.fixed.push_back(static_cast<int>(table.nodes.size()));
    table.nodes.emplace_back(values[0], values[1], values[2]);
  }
  if (table.nodes.empty())
    fail(path, 0, "no node", "a line a node");
  return table;
}
}  // namespace

ElasticParts readMatrices(const std::string& mass, const std::string& stiffness, const std::string& nodes)
{
  NodeTable table = readNodes(nodes);
  const auto count = static_cast<long>(table.nodes.size());
  ElasticParts parts;
  parts.mass = readMatrixMarket(mass, count, 0);
  parts.stiffness = readMatrixMarket(stiffness, count, parts.mass.rows());
  parts.dimension = static_cast<int>(parts.mass.rows() / count);
  parts.nodes = std::move(table.nodes);
  parts.surface = std::move(table.surface);
  if (!table.fixed.empty())
    parts.groups["fixed"] = std::move(table.fixed);
  return parts;
}

}  // namespace frictional_contact_sim
