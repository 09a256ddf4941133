// Matrices of a finite-element program: Matrix Market (Boisvert, Pozo, Remington 1996) and a table of nodes.
#include <algorithm>
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

SparseRows readMatrixMarket(const std::string& path, Eigen::Index size)
{
  std::ifstream file = openFile(path, "a Matrix Market file");
  std::string text;
  std::getline(file, text);
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  std::istringstream head(text);
  std::string words[5];
  for (std::string& word : words)
    head >> word;
  const bool is_symmetric = words[4] == "symmetric";
  if (words[0] != "%%matrixmarket" || words[1] != "matrix" || words[2] != "coordinate" ||
      (words[3] != "real" && words[3] != "integer") || (!is_symmetric && words[4] != "general"))
    fail(path, 1, "'" + text + "'", "%%MatrixMarket matrix coordinate real general or symmetric");
  int line = 1;
  const auto next = [&]
  {
    while (std::getline(file, text))
    {
      ++line;
      if (!text.empty() && text[0] != '%' && text.find_first_not_of(" \t\r") != std::string::npos)
        return true;
    }
    return false;
  };
  long rows = 0;
  long columns = 0;
  long count = 0;
  if (!next() || !(std::istringstream(text) >> rows >> columns >> count) || count < 0)
    fail(path, line, "'" + text + "'", "rows, columns, entries");
  if (rows != size || columns != size)
    fail(path, line, std::to_string(rows) + " x " + std::to_string(columns),
         std::to_string(size) + " x " + std::to_string(size) + ", as the table of nodes and the mass matrix say");
  std::vector<Eigen::Triplet<double>> entries;
  for (long k = 0; k < count; ++k)
  {
    long row = 0;
    long column = 0;
    double value = 0.0;
    if (!next())
      fail(path, line, std::to_string(k) + " entries", std::to_string(count));
    if (!(std::istringstream(text) >> row >> column >> value) || row < 1 || column < 1 || row > size || column > size ||
        !std::isfinite(value))
      fail(path, line, "'" + text + "'", "row, column, finite value");
    entries.emplace_back(row - 1, column - 1, value);
    if (is_symmetric && row != column)
      entries.emplace_back(column - 1, row - 1, value);
  }
  if (next())
    fail(path, line, "'" + text + "'", "the end of the file after " + std::to_string(count) + " entries");
  SparseRows matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
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
  const auto cellsOf = [](std::string text)
  {
    text.erase(std::remove_if(text.begin(), text.end(), [](char c) { return c == ' ' || c == '\r' || c == '\t'; }),
               text.end());
    std::vector<std::string> cells;
    std::istringstream line(text);
    for (std::string cell; std::getline(line, cell, ',');)
      cells.push_back(cell);
    return cells;
  };
  static const char* const COLUMNS[] = {"x", "y", "z", "surface", "fixed"};
  std::string text;
  std::getline(file, text);
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
  for (int line = 2; std::getline(file, text); ++line)
  {
    const std::vector<std::string> cells = cellsOf(text);
    if (cells.empty())
      continue;
    double values[5] = {0.0, 0.0, 0.0, place[3] < 0 ? 1.0 : 0.0, 0.0};
    for (int k = 0; k < 5; ++k)
    {
      if (place[k] < 0)
        continue;
      std::istringstream cell(place[k] < static_cast<int>(cells.size()) ? cells[place[k]] : "");
      if (!(cell >> values[k]) || !cell.eof() || !std::isfinite(values[k]))
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

/** Rows of a Matrix Market file, from its second line. */
long rowsOf(const std::string& path)
{
  std::ifstream file = openFile(path, "a Matrix Market file");
  long rows = 0;
  for (std::string text; std::getline(file, text);)
    if (!text.empty() && text[0] != '%')
    {
      std::istringstream(text) >> rows;
      break;
    }
  return rows;
}
}  // namespace

ElasticParts readMatrices(const std::string& mass, const std::string& stiffness, const std::string& nodes)
{
  NodeTable table = readNodes(nodes);
  const auto count = static_cast<long>(table.nodes.size());
  const long rows = rowsOf(mass);
  if (rows % count != 0 || rows / count < 1 || rows / count > 3)
    fail(mass, 0, std::to_string(rows) + " rows for " + std::to_string(count) + " nodes of " + nodes,
         "1, 2 or 3 a node");
  ElasticParts parts;
  parts.dimension = static_cast<int>(rows / count);
  parts.nodes = std::move(table.nodes);
  parts.surface = std::move(table.surface);
  if (!table.fixed.empty())
    parts.groups["fixed"] = std::move(table.fixed);
  parts.mass = readMatrixMarket(mass, rows);
  parts.stiffness = readMatrixMarket(stiffness, rows);
  return parts;
}

}  // namespace frictional_contact_sim
