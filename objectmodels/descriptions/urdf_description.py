"""URDF, the model files of ROS; it knows friction only by the tags of Drake and Gazebo."""

from __future__ import annotations

from xml.sax.saxutils import quoteattr

from objectmodels.descriptions.rigid_body import FOOT, RELAXATION, RigidBody, Solid, numbers_text
from objectmodels.geometry.base_shapes import Array


def urdf_text(body: RigidBody, mesh: str) -> str:
    """A robot of one link.

    Args:
        body: to be described.
        mesh: name of the mesh file of its hull, beside this one.
    """
    xx, yy, zz = body.inertia.tolist()
    feet = "\n".join(
        _collision(place, f'<sphere radius="{FOOT}"/>', body, weight)
        for place, weight in zip(body.feet, body.weights, strict=True)
    )
    shapes = [_shape(solid, mesh) for solid in body.solids]
    visuals = "\n".join(_visual(place, shape) for shape, place in shapes)
    solids = "\n".join(_collision(place, shape, body, None) for shape, place in shapes)
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


def _visual(place: Array, shape: str) -> str:
    return f"""    <visual>
      <origin xyz="{numbers_text(place)}"/>
      <geometry>{shape}</geometry>
    </visual>"""


def _collision(place: Array, shape: str, body: RigidBody, weight: float | None) -> str:
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


def _shape(solid: Solid, mesh: str) -> tuple[str, Array]:
    """Geometry of a solid, and where its own frame is."""
    x, _, z = solid.size.tolist()
    if solid.shape == "box":
        return f'<box size="{numbers_text(solid.size)}"/>', solid.middle
    if solid.shape == "cylinder":
        return f'<cylinder radius="{x / 2.0:.15g}" length="{z:.15g}"/>', solid.middle
    return f'<mesh filename="{mesh}"><drake:declare_convex/></mesh>', 0.0 * solid.middle
