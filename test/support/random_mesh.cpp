#include "support/random_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

namespace frictional_contact_sim
{
namespace test_support
{
namespace
{
constexpr double PI = 3.14159265358979323846;
const char* const NAMES[] = {"sphere", "torus", "filleted_plate", "cone", "shell", "needle"};

/// Point of a meridian: distance from the axis and height.
struct Ring
{
  double radius;
  double height;
};

/// Area of the polygon of a ring over its radius squared.
double polygonFactor(int sides)
{
  return 0.5 * sides * std::sin(2.0 * PI / sides);
}

double volumeOfRings(const std::vector<Ring>& rings, int sides)
{
  double volume = 0.0;
  for (size_t i = 0; i + 1 < rings.size(); ++i)
  {
    const double r = rings[i].radius;
    const double s = rings[i + 1].radius;
    volume += polygonFactor(sides) * (r * r + r * s + s * s) * std::abs(rings[i + 1].height - rings[i].height) / 3.0;
  }
  return volume;
}

/// From the top down: a half circle, or the part of it up to an angle.
std::vector<Ring> arc(double radius, int steps, double angle = PI)
{
  std::vector<Ring> rings;
  for (int i = 0; i <= steps; ++i)
  {
    const double theta = angle * i / steps;
    rings.push_back({i == 0 || (i == steps && angle == PI) ? 0.0 : radius * std::sin(theta), radius * std::cos(theta)});
  }
  return rings;
}

/// Rows of points with a triangle strip between each two; points that are the same are one.
class Builder
{
public:
  explicit Builder(RandomMesh& mesh) : mesh_(mesh) {}

  void addRow(const std::vector<Eigen::Vector3d>& points)
  {
    std::vector<int> row;
    for (const Eigen::Vector3d& point : points)
    {
      const auto known = std::find_if(row.begin(), row.end(), [&](int v) { return mesh_.vertices[v] == point; });
      const bool is_new = known == row.end();
      row.push_back(is_new ? static_cast<int>(mesh_.vertices.size()) : *known);
      if (is_new)
        mesh_.vertices.push_back(point);
    }
    if (!last_.empty())
      addStrip(last_, row);
    else
      first_ = row;
    last_ = row;
  }
  void closeRows() { addStrip(last_, first_); }
  /// A fan over the last row, or over the first one from the other side.
  void addCap(bool is_first)
  {
    const std::vector<int>& row = is_first ? first_ : last_;
    for (size_t k = 1; k + 1 < row.size(); ++k)
      is_first ? add(row[0], row[k], row[k + 1]) : add(row[0], row[k + 1], row[k]);
  }

private:
  void addStrip(const std::vector<int>& upper, const std::vector<int>& lower)
  {
    for (size_t k = 0; k < upper.size(); ++k)
    {
      const size_t next = (k + 1) % upper.size();
      add(upper[k], lower[k], lower[next]);
      add(upper[k], lower[next], upper[next]);
    }
  }
  void add(int i, int j, int k)
  {
    if (i != j && j != k && i != k)
      mesh_.triangles.push_back({i, j, k});
  }

  RandomMesh& mesh_;
  std::vector<int> first_;
  std::vector<int> last_;
};

/// Points of a ring; `shift` moves each quadrant outwards (half sizes of a box), sides a multiple of four then.
std::vector<Eigen::Vector3d> ringPoints(const Ring& ring, int sides, const Eigen::Vector2d& shift)
{
  std::vector<Eigen::Vector3d> points;
  const bool is_shifted = !shift.isZero();
  for (int k = 0; k < sides; ++k)
  {
    const double phi = 2.0 * PI * k / sides;
    const bool is_axis = is_shifted && 4 * k % sides == 0;
    const int quadrant = 4 * k / sides;
    const Eigen::Vector2d on_circle =
        is_axis ? Eigen::Vector2d(quadrant % 2 == 0 ? 1 - quadrant : 0, quadrant % 2 == 1 ? 2 - quadrant : 0)
                : Eigen::Vector2d(std::cos(phi), std::sin(phi));
    // on an axis the point belongs to the quadrant before as well
    for (int q = is_axis ? quadrant + 3 : quadrant; q <= (is_axis ? quadrant + 4 : quadrant); ++q)
    {
      const Eigen::Vector2d sign(q % 4 == 0 || q % 4 == 3 ? 1.0 : -1.0, q % 4 < 2 ? 1.0 : -1.0);
      const Eigen::Vector2d flat = ring.radius * on_circle + sign.cwiseProduct(shift);
      points.emplace_back(flat.x(), flat.y(), ring.height);
    }
  }
  return points;
}

void addRings(const std::vector<Ring>& rings, int sides, RandomMesh& mesh)
{
  Builder builder(mesh);
  for (const Ring& ring : rings)
    builder.addRow(ringPoints(ring, sides, Eigen::Vector2d::Zero()));
  if (mesh.is_closed && rings.front().radius > 0.0)
    builder.addCap(true);
  if (mesh.is_closed && rings.back().radius > 0.0)
    builder.addCap(false);
  mesh.hull_volume = volumeOfRings(rings, sides);
}

void addTorus(double ring_radius, double tube_radius, int steps, int sides, RandomMesh& mesh)
{
  Builder builder(mesh);
  std::vector<Ring> outside;
  for (int i = 0; i < steps; ++i)  // steps a multiple of four: the top, the outside, the bottom, the inside
  {
    const double theta = 2.0 * PI * i / steps;
    const Ring ring{ring_radius + tube_radius * std::sin(theta), tube_radius * std::cos(theta)};
    if (2 * i <= steps)
      outside.push_back(ring);
    builder.addRow(ringPoints(ring, sides, Eigen::Vector2d::Zero()));
  }
  builder.closeRows();
  mesh.is_convex = false;
  mesh.hull_volume = volumeOfRings(outside, sides);
}

void addFilletedPlate(const Eigen::Vector3d& half, double radius, int steps, int sides, RandomMesh& mesh)
{
  Builder builder(mesh);
  for (const double side : {1.0, -1.0})
    for (int i = 0; i <= steps; ++i)
    {
      const double theta = 0.5 * PI * (side > 0.0 ? i : steps - i) / steps;
      const Ring ring{radius * std::sin(theta),
                      side * (half.z() + (theta < 0.5 * PI ? radius * std::cos(theta) : 0.0))};
      builder.addRow(ringPoints(ring, sides, half.head<2>()));
    }
  builder.addCap(true);
  builder.addCap(false);
  const double across = polygonFactor(4 * steps) * radius * radius;
  mesh.hull_volume = 8.0 * half.prod() +
                     8.0 * radius * (half.x() * half.y() + half.y() * half.z() + half.z() * half.x()) +
                     2.0 * (half.x() + half.y()) * across + 2.0 * half.z() * polygonFactor(sides) * radius * radius +
                     volumeOfRings(arc(radius, 2 * steps), sides);
}

void setSize(RandomMesh& mesh)
{
  Eigen::Vector3d low = mesh.vertices.front();
  Eigen::Vector3d high = low;
  for (const Eigen::Vector3d& vertex : mesh.vertices)
  {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  mesh.size = 0.0;
  for (const Eigen::Vector3d& vertex : mesh.vertices)
    mesh.size = std::max(mesh.size, (vertex - 0.5 * (low + high)).norm());
}

void rescale(double factor, RandomMesh& mesh)
{
  for (Eigen::Vector3d& vertex : mesh.vertices)
    vertex *= factor;
  mesh.hull_volume *= factor * factor * factor;
  setSize(mesh);
}
}  // namespace

RandomMesh makeRandomMesh(MeshKind kind, double size, Dice& dice)
{
  RandomMesh mesh;
  mesh.kind = kind;
  mesh.name = NAMES[static_cast<int>(kind)];
  const int steps = 4 * static_cast<int>(dice.logUniform(1.0, 20.0));  // most are coarse
  const int sides = 4 * static_cast<int>(dice.logUniform(1.0, 60.0));
  switch (kind)
  {
    case MeshKind::TORUS:
      addTorus(1.0, dice.uniform(0.05, 0.9), steps, sides, mesh);
      break;
    case MeshKind::FILLETED_PLATE:
      addFilletedPlate({1.0, dice.uniform(0.2, 1.0), dice.uniform(0.0, 0.2)}, dice.logUniform(0.005, 0.2), steps / 2,
                       sides, mesh);
      break;
    case MeshKind::CONE:
      addRings({{0.0, dice.uniform(0.1, 4.0)}, {1.0, 0.0}}, sides, mesh);
      break;
    case MeshKind::SHELL:
      mesh.is_closed = false;
      mesh.is_convex = false;
      addRings(arc(1.0, steps, dice.uniform(0.1, 1.5)), sides, mesh);
      break;
    default:
    {
      std::vector<Ring> rings = arc(1.0, steps);
      const double width = kind == MeshKind::NEEDLE ? 1.0 / dice.logUniform(20.0, 1000.0) : 1.0;
      for (Ring& ring : rings)
        ring.radius *= width;
      addRings(rings, sides, mesh);
    }
  }
  setSize(mesh);
  rescale(size / mesh.size, mesh);
  return mesh;
}

RandomMesh makeRandomMesh(std::uint32_t seed)
{
  Dice dice(seed);
  const int kinds = static_cast<int>(MeshKind::KINDS);
  const double size = dice.logUniform(1e-3, 1e2);
  RandomMesh mesh = makeRandomMesh(static_cast<MeshKind>(seed % kinds), size, dice);
  mesh.name += "_" + std::to_string(seed);
  const Eigen::Vector3d axis = dice.vector(1.0) + Eigen::Vector3d(0.0, 0.0, 1e-3);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(dice.uniform(-PI, PI), axis.normalized()).toRotationMatrix();
  const bool is_turned = dice.chance(0.7);
  const Eigen::Vector3d offset = dice.chance(0.5) ? Eigen::Vector3d(dice.vector(size)) : Eigen::Vector3d::Zero();
  for (Eigen::Vector3d& vertex : mesh.vertices)
    vertex = (is_turned ? Eigen::Vector3d(turn * vertex) : vertex) + offset;
  setSize(mesh);
  return mesh;
}

void writeStl(const RandomMesh& mesh, const std::string& path)
{
  std::string bytes(80, ' ');
  const auto append = [&](const void* data, size_t size) { bytes.append(static_cast<const char*>(data), size); };
  const std::uint32_t count = static_cast<std::uint32_t>(mesh.triangles.size());
  append(&count, 4);
  for (const std::array<int, 3>& triangle : mesh.triangles)
  {
    const Eigen::Vector3d& origin = mesh.vertices[triangle[0]];
    const Eigen::Vector3d normal =
        (mesh.vertices[triangle[1]] - origin).cross(mesh.vertices[triangle[2]] - origin).normalized();
    for (const Eigen::Vector3d& vector :
         {normal, mesh.vertices[triangle[0]], mesh.vertices[triangle[1]], mesh.vertices[triangle[2]]})
    {
      const Eigen::Vector3f single = vector.cast<float>();
      append(single.data(), 12);
    }
    bytes.append(2, '\0');
  }
  std::ofstream(path, std::ios::binary) << bytes;
}

void writeObj(const std::vector<RandomMesh>& meshes, const std::string& path)
{
  std::ofstream file(path);
  file.precision(9);
  int first = 1;
  for (size_t k = 0; k < meshes.size(); ++k)
  {
    const RandomMesh& mesh = meshes[k];
    file << "o " << mesh.name << '.' << k << '\n';  // assimp makes one of two objects with the same name
    for (const Eigen::Vector3d& vertex : mesh.vertices)
      file << "v " << vertex.x() << ' ' << vertex.y() << ' ' << vertex.z() << '\n';
    for (const std::array<int, 3>& triangle : mesh.triangles)
      file << "f " << first + triangle[0] << ' ' << first + triangle[1] << ' ' << first + triangle[2] << '\n';
    first += static_cast<int>(mesh.vertices.size());
  }
}

}  // namespace test_support
}  // namespace frictional_contact_sim
