"""Whole faces of the objects of a scene, pushed by a force in simulation, beside their prediction.

The tables say at what share of the contacts the class is as predicted, outside the band where the
prediction is undecided, and how large the median error of the force is: for what the robot believes
and for the true parameters, which show what prediction and simulation differ by in themselves.

    python -m benchmarks.faces [--scene kitchen] [--face front] [--spacing 10] [--workers 2]
"""

from __future__ import annotations

import argparse
from time import perf_counter

from nlcontrol.outcome_maps.face_experiment import Comparison, FaceExperiment, contacts_of
from nlcontrol.references.object_names import face_of
from nlcontrol.session.controller import Controller
from objectmodels import ObjectModel
from objectmodels.mechanics.outcome_map import outcome_map
from sim.simulated_executor import simulation


def true_model(controller: Controller, name: str) -> ObjectModel:
    """The belief about an object with the scene's true parameters in it; its shape is right."""
    truth = simulation(controller.executor).truth(name)
    belief = controller.models[name]
    stated = belief.model_dump(exclude={"friction_radius", "friction_radius_sd", "correlations"})
    changes = {
        "mass": truth.mass_kg,
        "friction": truth.friction_table,
        "com": truth.centre_of_mass,
        "support": [list(point) for point in truth.support],
    }
    return type(belief).model_validate(stated | changes)


def compared(
    controller: Controller, name: str, face: str, spacing: float, workers: int | None
) -> tuple[Comparison, Comparison, float]:
    """Of one object: belief and truth against the experiment, and the experiment's time [s]."""
    believed, true = (
        outcome_map(model, face_of(model, face), spacing=spacing)
        for model in (controller.models[name], true_model(controller, name))
    )
    scene = simulation(controller.executor).scene
    start = perf_counter()
    results = FaceExperiment(scene, contacts_of(believed, name, face)).run(workers=workers)
    seconds = perf_counter() - start
    first, second = (
        Comparison(chart, results, name, face, scene.name, "force", 0) for chart in (believed, true)
    )
    return first, second, seconds


def row(model: str, found: Comparison, seconds: float) -> str:
    """One line of the table."""
    agree, count = int(found.agrees.sum()), int(found.is_comparable.sum())
    return (
        f"| {found.object} | {model} | {len(found.results)} | {agree} of {count}, "
        f"{100 * (found.agreement or 0.0):.1f} % | {100 * (found.median_error or 0.0):.2f} % "
        f"| {seconds:.0f} s |"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--scene", default="kitchen")
    parser.add_argument("--face", default="front")
    parser.add_argument("--spacing", type=float, default=10.0, help="between contacts [mm]")
    parser.add_argument("--workers", type=int)
    options = parser.parse_args()
    controller = Controller(options.scene)
    print("| object | parameters | contacts | same class | force, median error | time |")
    print("|---|---|---|---|---|---|")
    for name in controller.cell.names:
        believed, true, seconds = compared(
            controller, name, options.face, 1e-3 * options.spacing, options.workers
        )
        print(row("believed", believed, seconds))
        print(row("true", true, seconds), flush=True)


if __name__ == "__main__":
    main()
