"""Open Job Description 2023-09, which `openjd` and AWS Deadline Cloud run:
https://github.com/OpenJobDescription/openjd-specifications
"""

from __future__ import annotations

import json
from typing import Any

from .job import Job, Still

NOTICE_SECONDS = 120
"""For a checkpoint, before a cancelled task is ended."""


def files(job: Job) -> dict[str, str]:
    """Contents by name."""
    values = {"Scene": job.scene, "OutputDir": job.output}
    deadline = {"parameterValues": [{"name": k, "value": v} for k, v in values.items()]}
    return {
        "template.json": json.dumps(template(job), indent=2) + "\n",
        "parameters.json": json.dumps(values, indent=2) + "\n",  # as openjd reads them
        "parameter_values.json": json.dumps(deadline, indent=2) + "\n",  # as Deadline Cloud does
    }


def template(job: Job) -> dict[str, Any]:
    scene, output, command = "{{Param.Scene}}", "{{Param.OutputDir}}", "{{Param.PhotonSplat}}"
    parameters: list[dict[str, Any]] = [
        {
            "name": "Scene",
            "type": "PATH",
            "objectType": "FILE",
            "dataFlow": "IN",
            "description": "The .blend file.",
        },
        {
            "name": "OutputDir",
            "type": "PATH",
            "objectType": "DIRECTORY",
            "dataFlow": "OUT",
            "description": "The folder of the results.",
        },
        {
            "name": "PhotonSplat",
            "type": "STRING",
            "default": job.command,
            "description": "The command photon-splat on the workers.",
        },
    ]
    if isinstance(job.what, Still):
        count = "{{Param.Parts}}"
        parameters.append(
            {
                "name": "Parts",
                "type": "INT",
                "minValue": 1,
                "default": job.what.parts,
                "description": "Parts of the picture, which machines render at the same time.",
            }
        )
        task: dict[str, Any] = {"name": "Part", "type": "INT", "range": f"1-{count}"}
        arguments = job.render(scene, output, "{{Task.Param.Part}}", count)
    else:
        task = {"name": "Frames", "type": "STRING", "range": job.what.chunks}
        arguments = job.render(scene, output, "{{Task.Param.Frames}}", "")
    steps: list[dict[str, Any]] = [
        {
            "name": "Render",
            "parameterSpace": {"taskParameterDefinitions": [task]},
            "script": _script(command, arguments),
        }
    ]
    if isinstance(job.what, Still):
        steps.append(
            {
                "name": "Merge",
                "dependencies": [{"dependsOn": "Render"}],
                "script": _script(command, job.merge(output, "{{Param.Parts}}")),
            }
        )
    return {
        "specificationVersion": "jobtemplate-2023-09",
        "name": job.name,
        "parameterDefinitions": parameters,
        "steps": steps,
    }


def _script(command: str, arguments: list[str]) -> dict[str, Any]:
    return {
        "actions": {
            "onRun": {
                "command": command,
                "args": arguments,
                "cancelation": {
                    "mode": "NOTIFY_THEN_TERMINATE",
                    "notifyPeriodInSeconds": NOTICE_SECONDS,
                },
            }
        }
    }
