"""A model written for other simulators: MJCF, SDF and URDF.

SDF, the model files of Gazebo and others; Drake reads its stiffnesses by their own tags.
"""

from __future__ import annotations

from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

import numpy as np

from objectmodels.descriptions.rigid_body import FOOT, RELAXATION, RigidBody, numbers_text
from objectmodels.geometry.base_shapes import Array
from objectmodels.geometry.solids import ConvexHull, Cuboid, UprightCylinder
from objectmodels.mechanics.push_thresholds import GRAVITY


def obj_text(vertices: Array) -> str:
    """The hull of vertices, shape (n, 3) [m], as triangles that look outwards."""
    from scipy.spatial import ConvexHull  # takes a while to import

    hull = ConvexHull(vertices)
    number = {int(vertex): k for k, vertex in enumerate(hull.vertices, start=1)}
    lines = [f"v {x:.15g} {y:.15g} {z:.15g}" for x, y, z in vertices[hull.vertices]]
    for (a, b, c), equation in zip(hull.simplices, hull.equations, strict=True):
        normal = np.cross(vertices[b] - vertices[a], vertices[c] - vertices[a])
        corners = (a, b, c) if normal @ equation[:3] > 0.0 else (a, c, b)
        lines.append("f " + " ".join(str(number[int(corner)]) for corner in corners))
    return "\n".join(lines) + "\n"


def mesh_texts(body: RigidBody) -> list[str]:
    """Texts of the mesh files that the solids of a body need: one for a hull."""
    return [text for solid in body.solids.values() for text in solid.accept(_ObjMeshes())]


class _ObjMeshes:
    """Mesh files of a solid."""

    def cuboid(self, solid: Cuboid) -> tuple[str, ...]:
        del solid
        return ()

    def cylinder(self, solid: UprightCylinder) -> tuple[str, ...]:
        del solid
        return ()

    def hull(self, solid: ConvexHull) -> tuple[str, ...]:
        return (obj_text(solid.vertices),)


# MJCF, the model files of MuJoCo.
#
# A constraint's force f is (k r − b v − a) / R, with penetration r, speed v, acceleration a and
# the regularisation R = (1 − d)/d · 1/m, the same for all feet where the impedance d is.
# Stiffnesses that are stated (`solref` with negative numbers) are then springs in the ratio of
# the weights. A mass on n of them moves with
#
#     (ρ + n) a = Σk r − Σb v − ρ g,  ρ = (1 − d)/d,
#
# so that frequency ω and critical damping ask for Σk = (ρ + n) ω² and Σb = 2 (ρ + n) ω. MuJoCo
# takes k and b from what is stated by dividing by d.
#
# Friction of a pair is that of the geom of higher priority, which the feet and the solid have.

_IMPEDANCE = 0.5
_FREQUENCY = 450.0
"""Of the mass on its feet, ω [rad/s]; steps of a millisecond bear it."""


def mjcf_text(body: RigidBody) -> str:
    """A model of one free body; its world has gravity and steps, and no table yet."""
    share = (1.0 - _IMPEDANCE) + _IMPEDANCE * len(body.feet)
    stiffness, damping = share * _FREQUENCY**2, 2.0 * share * _FREQUENCY
    feet = "\n".join(
        f'      <geom class="foot" pos="{numbers_text(place)}"'
        f' solref="{-stiffness * weight:.15g} {-damping * weight:.15g}"/>'
        for place, weight in zip(body.feet, body.weights, strict=True)
    )
    shapes = [(name, *solid.accept(_MjcfGeometry())) for name, solid in body.solids.items()]
    asset = "".join(mesh for _, _, mesh in shapes)
    solids = "\n".join(
        f'      <geom name="{name}" {geometry} condim="3" priority="1"\n'
        f'        friction="{body.finger_friction:.15g} 0 0"/>'
        for name, geometry, _ in shapes
    )
    com, inertia = numbers_text(body.com), numbers_text(body.inertia)
    return f"""<mujoco model={quoteattr(body.name)}>
  <option timestep="0.001" gravity="0 0 {-GRAVITY}" cone="elliptic" impratio="1000"/>
  <default>
    <default class="foot">
      <geom type="sphere" size="{FOOT}" friction="{body.friction:.15g} 0 0" condim="3" priority="1"
        solimp="{_IMPEDANCE} {_IMPEDANCE} 0.001" group="3"/>
    </default>
  </default>{asset}
  <worldbody>
    <body name={quoteattr(body.name)}>
      <freejoint/>
      <inertial pos="{com}" mass="{body.mass:.15g}" diaginertia="{inertia}"/>
{solids}
{feet}
    </body>
  </worldbody>
</mujoco>
"""


class _MjcfGeometry:
    """Attributes of a geom that tell its shape and place, and the mesh that a hull needs."""

    def cuboid(self, solid: Cuboid) -> tuple[str, str]:
        half, middle = numbers_text(solid.size / 2.0), numbers_text(solid.middle)
        return f'type="box" size="{half}" pos="{middle}"', ""

    def cylinder(self, solid: UprightCylinder) -> tuple[str, str]:
        size = f"{solid.radius:.15g} {solid.length / 2.0:.15g}"
        return f'type="cylinder" size="{size}" pos="{numbers_text(solid.middle)}"', ""

    def hull(self, solid: ConvexHull) -> tuple[str, str]:
        corners = "  ".join(numbers_text(vertex) for vertex in solid.vertices)
        mesh = f'\n  <asset>\n    <mesh name="hull" vertex="{corners}"/>\n  </asset>'
        return 'type="mesh" mesh="hull"', mesh


def sdf_text(body: RigidBody, mesh: str) -> str:
    """A model of one link.

    Args:
        body: to be described.
        mesh: name of the mesh file of its hull, beside this one.
    """
    xx, yy, zz = body.inertia.tolist()
    feet = "\n".join(
        _sdf_collision(
            f"foot_{k}", place, f"<sphere><radius>{FOOT}</radius></sphere>", body, weight
        )
        for k, (place, weight) in enumerate(zip(body.feet, body.weights, strict=True))
    )
    written = _SdfGeometry(mesh)
    shapes = [(name, *solid.accept(written)) for name, solid in body.solids.items()]
    visuals = "\n".join(_sdf_visual(name, place, shape) for name, shape, place in shapes)
    solids = "\n".join(
        _sdf_collision(name, place, shape, body, None) for name, shape, place in shapes
    )
    return f"""<?xml version="1.0"?>
<sdf version="1.9" xmlns:drake="http://drake.mit.edu">
  <model name={quoteattr(body.name)}>
    <link name={quoteattr(body.name)}>
      <inertial>
        <pose>{numbers_text(body.com)} 0 0 0</pose>
        <mass>{body.mass:.15g}</mass>
        <inertia>
          <ixx>{xx:.15g}</ixx><iyy>{yy:.15g}</iyy><izz>{zz:.15g}</izz>
          <ixy>0</ixy><ixz>0</ixz><iyz>0</iyz>
        </inertia>
      </inertial>
{visuals}
{solids}
{feet}
    </link>
  </model>
</sdf>
"""


def _sdf_visual(name: str, place: Array, shape: str) -> str:
    return f"""      <visual name="{name}">
        <pose>{numbers_text(place)} 0 0 0</pose>
        <geometry>{shape}</geometry>
      </visual>"""


def _sdf_collision(
    name: str, place: Array, shape: str, body: RigidBody, weight: float | None
) -> str:
    """A collision geometry: a foot of a weight, or the solid, which has none."""
    mu = body.finger_friction if weight is None else body.friction
    spring = ""
    if weight is not None:
        stiffness = weight * body.stiffness
        spring = f"""
        <drake:proximity_properties>
          <drake:point_contact_stiffness>{stiffness:.15g}</drake:point_contact_stiffness>
          <drake:relaxation_time>{RELAXATION}</drake:relaxation_time>
        </drake:proximity_properties>"""
    return f"""      <collision name="{name}">
        <pose>{numbers_text(place)} 0 0 0</pose>
        <geometry>{shape}</geometry>
        <surface><friction><ode><mu>{mu:.15g}</mu><mu2>{mu:.15g}</mu2></ode></friction></surface>{spring}
      </collision>"""


@dataclass(frozen=True)
class _SdfGeometry:
    """Geometry of a solid, and where its own frame is; a hull's is in a mesh file."""

    mesh: str

    def cuboid(self, solid: Cuboid) -> tuple[str, Array]:
        return f"<box><size>{numbers_text(solid.size)}</size></box>", solid.middle

    def cylinder(self, solid: UprightCylinder) -> tuple[str, Array]:
        size = f"<radius>{solid.radius:.15g}</radius><length>{solid.length:.15g}</length>"
        return f"<cylinder>{size}</cylinder>", solid.middle

    def hull(self, solid: ConvexHull) -> tuple[str, Array]:
        del solid
        uri = f"<uri>{self.mesh}</uri><drake:declare_convex/>"
        return f"<mesh>{uri}</mesh>", np.zeros(3)


def urdf_text(body: RigidBody, mesh: str) -> str:
    """A robot of one link.

    Args:
        body: to be described.
        mesh: name of the mesh file of its hull, beside this one.
    """
    xx, yy, zz = body.inertia.tolist()
    feet = "\n".join(
        _urdf_collision(place, f'<sphere radius="{FOOT}"/>', body, weight)
        for place, weight in zip(body.feet, body.weights, strict=True)
    )
    written = _UrdfGeometry(mesh)
    shapes = [solid.accept(written) for solid in body.solids.values()]
    visuals = "\n".join(_urdf_visual(place, shape) for shape, place in shapes)
    solids = "\n".join(_urdf_collision(place, shape, body, None) for shape, place in shapes)
    return f"""<?xml version="1.0"?>
<robot name={quoteattr(body.name)} xmlns:drake="http://drake.mit.edu">
  <link name={quoteattr(body.name)}>
    <inertial>
      <origin xyz="{numbers_text(body.com)}"/>
      <mass value="{body.mass:.15g}"/>
      <inertia ixx="{xx:.15g}" iyy="{yy:.15g}" izz="{zz:.15g}" ixy="0" ixz="0" iyz="0"/>
    </inertial>
{visuals}
{solids}
{feet}
  </link>
  <gazebo reference={quoteattr(body.name)}>
    <mu1>{body.friction:.15g}</mu1>
    <mu2>{body.friction:.15g}</mu2>
  </gazebo>
</robot>
"""


def _urdf_visual(place: Array, shape: str) -> str:
    return f"""    <visual>
      <origin xyz="{numbers_text(place)}"/>
      <geometry>{shape}</geometry>
    </visual>"""


def _urdf_collision(place: Array, shape: str, body: RigidBody, weight: float | None) -> str:
    """A collision geometry: a foot of a weight, or the solid, which has none."""
    mu = body.finger_friction if weight is None else body.friction
    spring = ""
    if weight is not None:
        stiffness = weight * body.stiffness
        spring = f"""
        <drake:point_contact_stiffness value="{stiffness:.15g}"/>
        <drake:relaxation_time value="{RELAXATION}"/>"""
    return f"""    <collision>
      <origin xyz="{numbers_text(place)}"/>
      <geometry>{shape}</geometry>
      <drake:proximity_properties>
        <drake:mu_static value="{mu:.15g}"/>
        <drake:mu_dynamic value="{mu:.15g}"/>{spring}
      </drake:proximity_properties>
    </collision>"""


@dataclass(frozen=True)
class _UrdfGeometry:
    """Geometry of a solid, and where its own frame is; a hull's is in a mesh file."""

    mesh: str

    def cuboid(self, solid: Cuboid) -> tuple[str, Array]:
        return f'<box size="{numbers_text(solid.size)}"/>', solid.middle

    def cylinder(self, solid: UprightCylinder) -> tuple[str, Array]:
        size = f'radius="{solid.radius:.15g}" length="{solid.length:.15g}"'
        return f"<cylinder {size}/>", solid.middle

    def hull(self, solid: ConvexHull) -> tuple[str, Array]:
        del solid
        return f'<mesh filename="{self.mesh}"><drake:declare_convex/></mesh>', np.zeros(3)
