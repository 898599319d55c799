"""SDF, the model files of Gazebo and others; Drake reads its stiffnesses by their own tags."""

from __future__ import annotations

from xml.sax.saxutils import quoteattr

from objectmodels.descriptions.rigid_body import FOOT, RELAXATION, RigidBody, Solid, numbers_text
from objectmodels.geometry.base_shapes import Array


def sdf_text(body: RigidBody, mesh: str) -> str:
    """A model of one link.

    Args:
        body: to be described.
        mesh: name of the mesh file of its hull, beside this one.
    """
    xx, yy, zz = body.inertia.tolist()
    feet = "\n".join(
        _collision(f"foot_{k}", place, f"<sphere><radius>{FOOT}</radius></sphere>", body, weight)
        for k, (place, weight) in enumerate(zip(body.feet, body.weights, strict=True))
    )
    shapes = [(solid.name, *_shape(solid, mesh)) for solid in body.solids]
    visuals = "\n".join(_visual(name, place, shape) for name, shape, place in shapes)
    solids = "\n".join(_collision(name, place, shape, body, None) for name, shape, place in shapes)
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


def _visual(name: str, place: Array, shape: str) -> str:
    return f"""      <visual name="{name}">
        <pose>{numbers_text(place)} 0 0 0</pose>
        <geometry>{shape}</geometry>
      </visual>"""


def _collision(name: str, place: Array, shape: str, body: RigidBody, weight: float | None) -> str:
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


def _shape(solid: Solid, mesh: str) -> tuple[str, Array]:
    """Geometry of a solid, and where its own frame is."""
    x, _, z = solid.size.tolist()
    if solid.shape == "box":
        return f"<box><size>{numbers_text(solid.size)}</size></box>", solid.middle
    if solid.shape == "cylinder":
        size = f"<radius>{x / 2.0:.15g}</radius><length>{z:.15g}</length>"
        return f"<cylinder>{size}</cylinder>", solid.middle
    uri = f"<uri>{mesh}</uri><drake:declare_convex/>"
    return f"<mesh>{uri}</mesh>", 0.0 * solid.middle
