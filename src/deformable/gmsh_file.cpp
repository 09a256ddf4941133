// Gmsh's MSH files, formats 2.2 and 4.1 in ASCII (Gmsh reference manual, "MSH file format").
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "frictional_contact_sim/deformable/elastic_mesh.h"
#include "frictional_contact_sim/model/model_error.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int MOST_ENTITIES = 100000000;  ///< a count beyond this is a broken file

/** Element types that may stand in a file: those of lower dimension name groups. */
struct ElementType
{
  int number;
  int dimension;
  int nodes;
};
constexpr ElementType TYPES[] = {{15, 0, 1}, {1, 1, 2}, {2, 2, 3}, {4, 3, 4}};

class GmshReader
{
public:
  explicit GmshReader(const std::string& path) : path_(path), file_(path)
  {
    if (!file_)
      throw ModelError(path + ": cannot be read, expected a mesh of Gmsh");
  }

  ElasticMesh read()
  {
    std::string section;
    while (nextLine() && ((line_ >> section)))
    {
      if (section == "$MeshFormat")
        readFormat();
      else if (section == "$PhysicalNames")
        readNames();
      else if (section == "$Entities")
        readEntities();
      else if (section == "$Nodes")
        is_version_4_ ? readNodes4() : readNodes2();
      else if (section == "$Elements")
        is_version_4_ ? readElements4() : readElements2();
      skipTo("$End" + section.substr(std::min<size_t>(1, section.size())));
    }
    return finish();
  }

private:
  [[noreturn]] void fail(const std::string& found, const std::string& expected) const
  {
    throw ModelError(path_ + ":" + std::to_string(number_) + ": found " + found + ", expected " + expected);
  }

  bool nextLine()
  {
    std::string text;
    while (std::getline(file_, text))
    {
      ++number_;
      if (text.find_first_not_of(" \t\r") == std::string::npos)
        continue;
      line_.clear();
      line_.str(text);
      return true;
    }
    return false;
  }

  void needLine(const std::string& what)
  {
    if (!nextLine())
      fail("the end of the file", what);
  }

  template <typename T>
  T take(const std::string& what)
  {
    T value{};
    if (!(line_ >> value) || (!line_.eof() && !std::isspace(line_.peek())))
      fail("'" + line_.str() + "'", what);
    return value;
  }

  int count(const std::string& what)
  {
    const int number = take<int>("the number of " + what);
    if (number < 0 || number > MOST_ENTITIES)
      fail(std::to_string(number) + " " + what, "a count");
    return number;
  }

  void skipTo(const std::string& end)
  {
    std::string word;
    do
    {
      line_.clear();
      line_.seekg(0);
      if (line_ >> word && word == end)
        return;
    } while (nextLine());
    fail("the end of the file", end);
  }

  void readFormat()
  {
    needLine("a version");
    const auto version = take<double>("a version");
    const bool is_binary = take<int>("0 for ASCII") != 0;
    is_version_4_ = version >= 4.0;
    if (is_binary || (version != 2.2 && version != 4.1))
      fail("format " + std::to_string(version) + (is_binary ? " in binary" : ""), "2.2 or 4.1 in ASCII");
    has_format_ = true;
  }

  void readNames()
  {
    needLine("a count");
    for (int left = count("names"); left > 0; --left)
    {
      needLine("a physical name");
      const int dimension = take<int>("a dimension");
      const int tag = take<int>("a tag");
      const std::string& text = line_.str();
      const size_t first = text.find('"');
      const size_t last = text.rfind('"');
      if (first == std::string::npos || last <= first)
        fail("'" + text + "'", "a name in quotes");
      names_[{dimension, tag}] = text.substr(first + 1, last - first - 1);
    }
  }

  void readEntities()
  {
    needLine("four counts");
    std::array<int, 4> counts{};
    for (int& number : counts)
      number = count("entities");
    for (int dimension = 0; dimension < 4; ++dimension)
      for (int left = counts[dimension]; left > 0; --left)
      {
        needLine("an entity");
        const int tag = take<int>("a tag");
        for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k)
          take<double>("a bound");
        for (int groups = count("physical groups"); groups > 0; --groups)
          groups_of_[{dimension, tag}].push_back(take<int>("a physical group"));
      }
  }

  void addNode(long tag, double x, double y, double z)
  {
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z))
      fail("a coordinate that is not finite", "finite coordinates [m]");
    if (!index_.emplace(tag, static_cast<int>(nodes_.size())).second)
      fail("node " + std::to_string(tag) + " twice", "every node once");
    nodes_.emplace_back(x, y, z);
  }

  void readNodes2()
  {
    needLine("a count");
    for (int left = count("nodes"); left > 0; --left)
    {
      needLine("a node");
      const long tag = take<long>("a node's number");
      const auto x = take<double>("x");
      const auto y = take<double>("y");
      addNode(tag, x, y, take<double>("z"));
    }
  }

  void readNodes4()
  {
    needLine("counts");
    for (int blocks = count("blocks"); blocks > 0; --blocks)
    {
      needLine("a block");
      for (int k = 0; k < 3; ++k)
        take<int>("a block's dimension, tag and parametric");
      const int size = count("nodes");
      std::vector<long> tags;
      for (int k = 0; k < size; ++k)
      {
        needLine("a node's number");
        tags.push_back(take<long>("a node's number"));
      }
      for (const long tag : tags)
      {
        needLine("coordinates");
        const auto x = take<double>("x");
        const auto y = take<double>("y");
        addNode(tag, x, y, take<double>("z"));
      }
    }
  }

  /** Version 2.2 writes an element of two physical groups twice. */
  bool isOfAnotherGroup(const std::array<int, 4>& cell, const std::vector<int>& groups)
  {
    if (is_version_4_ || groups.empty())
      return false;
    std::set<int>& before = groups_of_cell_[cell];
    return before.insert(groups.front()).second && before.size() > 1;
  }

  void addElement(int type, const std::vector<int>& groups)
  {
    const auto known =
        std::find_if(std::begin(TYPES), std::end(TYPES), [type](const ElementType& one) { return one.number == type; });
    if (known == std::end(TYPES))
      fail("an element of type " + std::to_string(type),
           "points (15), lines (1), triangles (2) and tetrahedra (4) of first order");
    std::array<int, 4> cell{-1, -1, -1, -1};
    for (int k = 0; k < known->nodes; ++k)
    {
      const long tag = take<long>("a node's number");
      const auto found = index_.find(tag);
      if (found == index_.end())
        fail("node " + std::to_string(tag), "a node of the file");
      cell[k] = found->second;
    }
    if (known->dimension >= 2 && !isOfAnotherGroup(cell, groups))
      cells_[known->dimension - 2].push_back(cell);
    for (const int group : groups)
      if (const auto name = names_.find({known->dimension, group}); name != names_.end())
        for (int k = 0; k < known->nodes; ++k)
          members_[name->second].insert(cell[k]);
  }

  void readElements2()
  {
    needLine("a count");
    for (int left = count("elements"); left > 0; --left)
    {
      needLine("an element");
      take<long>("an element's number");
      const int type = take<int>("an element's type");
      std::vector<int> groups;
      for (int tags = count("tags"); tags > 0; --tags)
        groups.push_back(take<int>("a tag"));
      groups.resize(std::min<size_t>(1, groups.size()));  // the first is the physical one
      addElement(type, groups);
    }
  }

  void readElements4()
  {
    needLine("counts");
    for (int blocks = count("blocks"); blocks > 0; --blocks)
    {
      needLine("a block");
      const int dimension = take<int>("a dimension");
      const int entity = take<int>("an entity");
      const int type = take<int>("an element's type");
      for (int left = count("elements"); left > 0; --left)
      {
        needLine("an element");
        take<long>("an element's number");
        addElement(type, groups_of_[{dimension, entity}]);
      }
    }
  }

  /** Nodes that cells use, in the order of the file. */
  ElasticMesh finish()
  {
    if (!has_format_)
      fail("no $MeshFormat", "a mesh of Gmsh");
    ElasticMesh mesh;
    mesh.dimension = cells_[1].empty() ? 2 : 3;
    mesh.cells = cells_[mesh.dimension - 2];
    if (mesh.cells.empty())
      fail("no triangle and no tetrahedron", "a mesh of them");
    std::vector<int> place(nodes_.size(), -1);
    for (const std::array<int, 4>& cell : mesh.cells)
      for (int k = 0; k <= mesh.dimension; ++k)
        place[cell[k]] = 0;
    for (size_t node = 0; node < nodes_.size(); ++node)
      if (place[node] == 0)
      {
        place[node] = static_cast<int>(mesh.nodes.size());
        mesh.nodes.push_back(nodes_[node]);
      }
    for (std::array<int, 4>& cell : mesh.cells)
      for (int k = 0; k <= mesh.dimension; ++k)
        cell[k] = place[cell[k]];
    for (const auto& [name, nodes] : members_)
      for (const int node : nodes)
        if (place[node] >= 0)
          mesh.groups[name].push_back(place[node]);
    if (mesh.dimension == 2)
      for (Eigen::Vector3d& node : mesh.nodes)
      {
        if (node.z() != mesh.nodes.front().z() && &node != &mesh.nodes.front())
          throw ModelError(path_ +
                           ": found triangles that are not in a plane z = constant, expected a plane mesh or "
                           "tetrahedra");
      }
    if (mesh.dimension == 2)
      for (Eigen::Vector3d& node : mesh.nodes)
        node = Eigen::Vector3d(node.x(), 0.0, node.y());
    try
    {
      closeMesh(mesh);
    }
    catch (const ModelError& error)
    {
      throw ModelError(path_ + ": " + error.what());
    }
    return mesh;
  }

  std::string path_;
  std::ifstream file_;
  std::istringstream line_;
  int number_ = 0;
  bool has_format_ = false;
  bool is_version_4_ = false;
  std::map<std::pair<int, int>, std::string> names_;  ///< by dimension and tag
  std::map<std::pair<int, int>, std::vector<int>> groups_of_;  ///< entities: physical groups
  std::map<std::array<int, 4>, std::set<int>> groups_of_cell_;  ///< version 2.2: the first physical tags of a cell
  std::map<long, int> index_;
  std::vector<Eigen::Vector3d> nodes_;
  std::array<std::vector<std::array<int, 4>>, 2> cells_;  ///< triangles, tetrahedra
  std::map<std::string, std::set<int>> members_;
};
}  // namespace

ElasticMesh readGmsh(const std::string& path)
{
  return GmshReader(path).read();
}

}  // namespace frictional_contact_sim
