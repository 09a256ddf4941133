"""Solids for generated scenes: convex polyhedra, their exact mass properties, and their URDF and OBJ text."""
import itertools
import math


def subtract(a, b):
    return [a[i] - b[i] for i in range(3)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def hull_triangles(points):
    """Outward triangles of the hull of points in general position (all of them vertices); O(n^4), for n <= 20."""
    triangles = []
    for i, j, k in itertools.combinations(range(len(points)), 3):
        normal = cross(subtract(points[j], points[i]), subtract(points[k], points[i]))
        sides = [dot(normal, subtract(p, points[i])) for n, p in enumerate(points) if n not in (i, j, k)]
        if all(side < 0.0 for side in sides):
            triangles.append((i, j, k))
        elif all(side > 0.0 for side in sides):
            triangles.append((i, k, j))
    return triangles


def mass_properties(points, triangles, density):
    """Mass, centre and inertia about the centre (ixx, ixy, ixz, iyy, iyz, izz): sums over tetrahedra to the origin."""
    volume = 0.0
    first = [0.0] * 3
    second = [[0.0] * 3 for _ in range(3)]
    for triangle in triangles:
        a, b, c = (points[i] for i in triangle)
        det = dot(a, cross(b, c))
        volume += det / 6.0
        for i in range(3):
            first[i] += det / 24.0 * (a[i] + b[i] + c[i])
            for j in range(3):
                total = sum(p[i] * p[j] for p in (a, b, c)) + (a[i] + b[i] + c[i]) * (a[j] + b[j] + c[j])
                second[i][j] += det / 120.0 * total
    centre = [x / volume for x in first]
    cov = [[density * (second[i][j] - volume * centre[i] * centre[j]) for j in range(3)] for i in range(3)]
    inertia = (cov[1][1] + cov[2][2], -cov[0][1], -cov[0][2], cov[0][0] + cov[2][2], -cov[1][2], cov[0][0] + cov[1][1])
    return density * volume, centre, inertia


def urdf(name, mass, inertia, geometry):
    """One free link; geometry is a list of (element text, xyz)."""
    values = dict(zip(('ixx', 'ixy', 'ixz', 'iyy', 'iyz', 'izz'), inertia))
    inertia_text = ' '.join(f'{key}="{value:.17g}"' for key, value in values.items())
    collisions = '\n'.join(
        f'    <collision><origin xyz="{x:.17g} {y:.17g} {z:.17g}"/><geometry>{shape}</geometry></collision>'
        for shape, (x, y, z) in geometry)
    return (f'<?xml version="1.0"?>\n<robot name="{name}">\n  <link name="{name}">\n    <inertial><mass '
            f'value="{mass:.17g}"/><inertia {inertia_text}/></inertial>\n{collisions}\n  </link>\n</robot>\n')


def box(name, size, density):
    x, y, z = size
    m = density * x * y * z
    inertia = (m * (y * y + z * z) / 12, 0, 0, m * (x * x + z * z) / 12, 0, m * (x * x + y * y) / 12)
    return urdf(name, m, inertia, [(f'<box size="{x} {y} {z}"/>', (0, 0, 0))])


def sphere(name, radius, density):
    m = density * 4.0 / 3.0 * math.pi * radius**3
    i = 0.4 * m * radius**2
    return urdf(name, m, (i, 0, 0, i, 0, i), [(f'<sphere radius="{radius}"/>', (0, 0, 0))])


def capsule(name, radius, length, density):
    """Axis z; length of the cylindrical part. The half spheres' inertia by Steiner from their own centres (3/8 r)."""
    cylinder = density * math.pi * radius**2 * length
    ball = density * 4.0 / 3.0 * math.pi * radius**3
    along = 0.5 * cylinder * radius**2 + 0.4 * ball * radius**2
    across = cylinder * (radius**2 / 4 + length**2 / 12) + ball * (0.4 * radius**2 + length**2 / 4 +
                                                                   3.0 / 8.0 * length * radius)
    return urdf(name, cylinder + ball, (across, 0, 0, across, 0, along),
                [(f'<capsule radius="{radius}" length="{length}"/>', (0, 0, 0))])


def open_box(name, inner, height, wall):
    """A fixed container, open at the top, its floor's upper side at z = 0."""
    outer = inner + 2 * wall
    shift = 0.5 * (inner + wall)
    walls = [(f'<box size="{outer} {outer} {wall}"/>', (0, 0, -0.5 * wall))]
    for sign in (-1, 1):
        walls.append((f'<box size="{wall} {outer} {height}"/>', (sign * shift, 0, 0.5 * height)))
        walls.append((f'<box size="{outer} {wall} {height}"/>', (0, sign * shift, 0.5 * height)))
    return urdf(name, 1.0, (1, 0, 0, 1, 0, 1), walls)


def polyhedron(name, points, triangles, density):
    """(URDF text, OBJ text), the origin at the centre of mass. The mesh file is NAME.obj beside the URDF."""
    mass, centre, inertia = mass_properties(points, triangles, density)
    centred = [subtract(p, centre) for p in points]
    obj = ''.join('v {:.17g} {:.17g} {:.17g}\n'.format(*p) for p in centred)
    obj += ''.join('f {} {} {}\n'.format(*(i + 1 for i in t)) for t in triangles)
    text = urdf(name, mass, inertia, [(f'<mesh filename="{name}.obj"/>', (0, 0, 0))])
    return text, obj, centre


def rock(name, rng, size, density):
    """Random convex hull of 12 points on an ellipsoid."""
    axes = [size * rng.uniform(0.6, 1.0) for _ in range(3)]
    points = []
    while len(points) < 12:
        p = [rng.gauss(0, 1) for _ in range(3)]
        length = math.sqrt(dot(p, p))
        p = [a * x / length for a, x in zip(axes, p)]
        if all(math.dist(p, other) > 0.35 * size for other in points):
            points.append(p)
    return polyhedron(name, points, hull_triangles(points), density)


def voussoir(name, inner, outer, width, angle, density):
    """Wedge of an arch with its axis along y, its middle plane x = 0; also returns its centre in the arch's frame."""
    points = []
    for y in (-0.5 * width, 0.5 * width):
        for radius in (inner, outer):
            for side in (-0.5, 0.5):
                points.append([radius * math.sin(side * angle), y, radius * math.cos(side * angle)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = []
    middle = [sum(p[i] for p in points) / 8 for i in range(3)]
    for a, b, c, d in quads:
        normal = cross(subtract(points[b], points[a]), subtract(points[c], points[a]))
        if dot(normal, subtract(points[a], middle)) < 0:
            a, b, c, d = d, c, b, a
        triangles += [(a, b, c), (a, c, d)]
    return polyhedron(name, points, triangles, density)
