#pragma once
/**
 * @file contour.h
 * @brief Closed polygons of flat elements around a plane body, and the graded mesh of a cylinder.
 *
 * The body lies to the left of every element (outer contours counter-clockwise, holes clockwise). The cylinder of
 * radius R touches the origin from above, its centre is (0, R). Its first elements are the contact zone, from left to
 * right: contact_elements chords of equal length over |angle from the lowest point| <= half_angle; from there both
 * sides grow by `growth` from element to element up to max_angle; the arc with |angle from the top| < held_angle is
 * held (u = 0).
 */
#include <Eigen/Core>
#include <vector>

namespace frictional_contact_sim
{
enum class ElementKind
{
  CONTACT,  ///< traction and displacement unknown, kept
  FREE,  ///< t = 0
  HELD  ///< u = 0
};

struct Contour
{
  Eigen::Matrix2Xd begin, end;  ///< 2 x n, end points of the elements [m]
  std::vector<ElementKind> kinds;  ///< n

  Eigen::Index size() const { return begin.cols(); }
  Eigen::Vector2d middle(Eigen::Index i) const { return 0.5 * (begin.col(i) + end.col(i)); }
  double length(Eigen::Index i) const { return (end.col(i) - begin.col(i)).norm(); }
  Eigen::Vector2d tangent(Eigen::Index i) const { return (end.col(i) - begin.col(i)) / length(i); }
  /** @brief Unit normal out of the body. */
  Eigen::Vector2d normal(Eigen::Index i) const
  {
    const Eigen::Vector2d t = tangent(i);
    return {t.y(), -t.x()};
  }
  std::vector<Eigen::Index> select(ElementKind kind) const;
  double area() const;  ///< signed, by the shoelace formula; > 0 when the body is inside [m^2]

  /**
   * @brief Elements of positive length, closed polygons, no two elements crossing, body inside.
   * @throws std::invalid_argument with one line naming the element.
   */
  void validate() const;
};

struct CylinderMesh
{
  double radius = 1.0;  ///< R [m], > 0
  double half_angle = 0.1;  ///< half of the contact zone's arc [rad], in (0, pi/2]
  int contact_elements = 50;  ///< >= 1
  double growth = 1.15;  ///< ratio of neighbouring lengths outside the zone [-], >= 1
  double max_angle = 0.1;  ///< largest element outside the zone [rad], in (0, 0.5]
  double held_angle = 0.7853981633974483;  ///< half of the held arc around the top [rad], in (0, pi/2)

  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

Contour makeCylinderContour(const CylinderMesh& mesh);
/** @brief A closed polygon through the points (2 x n), all elements FREE; `kinds` can be set afterwards. */
Contour makePolygon(const Eigen::Matrix2Xd& points);
/** @brief Both contours as the boundary of one body (an outer one and a hole). */
Contour join(const Contour& first, const Contour& second);

}  // namespace frictional_contact_sim
