"""Flamenco 3: a job type, which is a JavaScript for the Manager's folder `scripts`, and a job of it
for the Manager's API: https://flamenco.blender.org/usage/job-types/
"""

from __future__ import annotations

import json
import sys

from .job import Job, Still, ranges

STILL = "photon-splat-still"
ANIMATION = "photon-splat-animation"

SETTINGS = """\
    {{ key: "blendfile", type: "string", required: true, visible: "web",
       description: "The .blend file, as workers reach it." }},
    {{ key: "output", type: "string", required: true, subtype: "dir_path",
       description: "The folder of the results, as workers reach it." }},
    {{ key: "name", type: "string", required: true, description: "Of the picture's files." }},
    {{ key: "options", type: "string", default: "", required: false,
       description: "More options of photon-splat render, with spaces in between." }},
"""

START = """\
// A job type of Flamenco 3, for the folder `scripts` of the Manager. The variable photonSplat of
// the Manager's configuration is the command photon-splat on the workers.
const JOB_TYPE = {{
  label: "{label}",
  settings: [
"""

END = """\

function render(settings, args) {{
  const more = settings.options ? settings.options.split(" ").filter((word) => word) : [];
  return command(["render", settings.blendfile, ...args, "--mkdir", ...more]);
}}

function command(args) {{
  return author.Command("exec", {{ exe: "{{photonSplat}}", args: args }});
}}
"""

STILL_SCRIPT = (
    START
    + SETTINGS
    + """\
    {{ key: "parts", type: "int32", default: 8, required: true,
       description: "Parts of the picture, which workers render at the same time." }},
    {{ key: "frame", type: "int32", default: 1, required: true, eval: "C.scene.frame_current",
       description: "Frame of the picture." }},
  ],
}};

function compileJob(job) {{
  const settings = job.settings;
  const merge = author.Task("merge", "misc");
  for (let part = 1; part <= settings.parts; part++) {{
    const file = settings.name + ".part_" + part + ".exr";
    const task = author.Task("part-" + part, "blender");
    task.addCommand(render(settings, [
      "-o", settings.output + "/parts/" + file,
      "--frame", String(settings.frame),
      "--part", part + "/" + settings.parts,
      "--checkpoint", settings.output + "/checkpoints/" + file,
    ]));
    job.addTask(task);
    merge.addDependency(task);
  }}
  merge.addCommand(command([
    "merge", settings.output + "/parts",
    "-o", settings.output + "/" + settings.name + ".exr",
    "--expect", String(settings.parts),
  ]));
  job.addTask(merge);
}}
"""
    + END
)

ANIMATION_SCRIPT = (
    START
    + SETTINGS
    + """\
    {{ key: "frames", type: "string", required: true,
       eval: "f'{{C.scene.frame_start}}-{{C.scene.frame_end}}'", description: "Like 1-250." }},
    {{ key: "chunk_size", type: "int32", default: 5, required: true,
       description: "Frames of a task." }},
  ],
}};

function compileJob(job) {{
  const settings = job.settings;
  for (const chunk of frameChunker(settings.frames, settings.chunk_size)) {{
    const task = author.Task("render-" + chunk, "blender");
    task.addCommand(render(settings, [
      "-o", settings.output + "/" + settings.name + "_####.exr",
      "--frames=" + chunk,
      "--skip-existing",
      "--strict",
    ]));
    job.addTask(task);
  }}
}}
"""
    + END
)


def files(job: Job) -> dict[str, str]:
    """Contents by name."""
    if isinstance(job.what, Still):
        kind, text = STILL, STILL_SCRIPT.format(label="Photon Splat: one picture in parts")
    else:
        kind, text = ANIMATION, ANIMATION_SCRIPT.format(label="Photon Splat: an animation")
    return {
        f"{kind.replace('-', '_')}.js": text,
        "job.json": json.dumps(request(job, kind), indent=2) + "\n",
    }


def request(job: Job, kind: str) -> dict[str, object]:
    """What POST /api/v3/jobs of the Manager takes."""
    settings: dict[str, object] = {
        "blendfile": job.scene,
        "output": job.output,
        "name": job.name,
        "options": " ".join(job.options),
    }
    if isinstance(job.what, Still):
        settings |= {"parts": job.what.parts, "frame": job.what.frame}
    else:
        settings |= {"frames": ranges(job.what.frames), "chunk_size": job.what.chunk}
    return {
        "name": job.name,
        "type": kind,
        "priority": 50,
        "submitter_platform": {"darwin": "darwin", "win32": "windows"}.get(sys.platform, "linux"),
        "settings": settings,
        "metadata": {},
    }
