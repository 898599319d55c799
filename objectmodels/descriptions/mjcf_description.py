"""MJCF, the model files of MuJoCo.

A constraint's force f is (k r − b v − a) / R, with penetration r, speed v, acceleration a and the
regularisation R = (1 − d)/d · 1/m, the same for all feet where the impedance d is. Stiffnesses that
are stated (`solref` with negative numbers) are then springs in the ratio of the weights. A mass on
n of them moves with

    (ρ + n) a = Σk r − Σb v − ρ g,  ρ = (1 − d)/d,

so that frequency ω and critical damping ask for Σk = (ρ + n) ω² and Σb = 2 (ρ + n) ω. MuJoCo takes
k and b from what is stated by dividing by d.

Friction of a pair is that of the geom of higher priority, which the feet and the solid have.
"""

from __future__ import annotations

from xml.sax.saxutils import quoteattr

from objectmodels.descriptions.rigid_body import FOOT, RigidBody, Solid, numbers_text
from objectmodels.mechanics.push_thresholds import GRAVITY

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
    asset = "".join(map(_asset, body.solids))
    solids = "\n".join(
        f'      <geom name="{solid.name}" {_geometry(solid)} condim="3" priority="1"\n'
        f'        friction="{body.finger_friction:.15g} 0 0"/>'
        for solid in body.solids
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


def _geometry(solid: Solid) -> str:
    """Attributes of a geom that tell its shape and place."""
    x, y, z = (solid.size / 2.0).tolist()
    place = f'pos="{numbers_text(solid.middle)}"'
    if solid.shape == "box":
        return f'type="box" size="{x:.15g} {y:.15g} {z:.15g}" {place}'
    if solid.shape == "cylinder":
        return f'type="cylinder" size="{x:.15g} {z:.15g}" {place}'
    return 'type="mesh" mesh="hull"'


def _asset(solid: Solid) -> str:
    """The mesh of a hull; nothing of other shapes."""
    if solid.shape != "hull":
        return ""
    corners = "  ".join(numbers_text(vertex) for vertex in solid.vertices)
    return f'\n  <asset>\n    <mesh name="hull" vertex="{corners}"/>\n  </asset>'
