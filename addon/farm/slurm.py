"""Slurm: an array of tasks, a merge that waits for all of them, and a script that submits both."""

from __future__ import annotations

import shlex

from .job import Job, Still

NOTICE_SECONDS = 120
"""Between SIGTERM and the time limit."""

ARRAY = """\
#!/bin/bash
#SBATCH --job-name={name}
#SBATCH --array=1-{tasks}
#SBATCH --output="{output}/logs/%A_%a.log"
#SBATCH --open-mode=append
#SBATCH --requeue
#SBATCH --signal=B:TERM@{notice}

# SIGTERM (preemption, or the time limit comes) goes on to the render, which keeps what there is;
# then the task is queued again and goes on from there.
asked= render=
trap 'asked=yes; [ -z "$render" ] || kill -TERM "$render"' TERM
{values}{command} &
render=$!
[ -z "$asked" ] || kill -TERM "$render"
while wait "$render"; status=$?; kill -0 "$render" 2>/dev/null; do :; done
if [ -n "$asked" ] && [ "$status" -ne 0 ]; then
  scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}" && sleep {notice}
fi
exit "$status"
"""

MERGE = """\
#!/bin/bash
#SBATCH --job-name={name}_merge
#SBATCH --output="{output}/logs/%j.log"

exec {command}
"""

SUBMIT = """\
#!/bin/sh
# Submits the job: submit.sh [options of sbatch, such as --partition and --cpus-per-task]
set -e
cd "$(dirname "$0")"
mkdir -p {output}/logs
array=$(sbatch --parsable "$@" render.sbatch)
echo "render: $array"
"""

SUBMIT_MERGE = """\
merge=$(sbatch --parsable "$@" --dependency="afterok:$array" --kill-on-invalid-dep=yes merge.sbatch)
echo "merge: $merge"
"""


def files(job: Job) -> dict[str, str]:
    """Contents by name."""
    still = isinstance(job.what, Still)
    if isinstance(job.what, Still):
        tasks, values, task = job.what.parts, "", "${SLURM_ARRAY_TASK_ID}"
    else:
        tasks, task = len(job.what.chunks), "${frames[SLURM_ARRAY_TASK_ID - 1]}"
        values = f"frames=({' '.join(map(shlex.quote, job.what.chunks))})\n"
    arguments = job.render(job.scene, job.output, "@TASK@", str(tasks))
    made = {
        "render.sbatch": ARRAY.format(
            name=job.name,
            tasks=tasks,
            output=job.output,
            notice=NOTICE_SECONDS,
            values=values,
            command=_words(job.command, arguments).replace("@TASK@", f"'\"{task}\"'"),
        ),
        "submit.sh": SUBMIT.format(output=shlex.quote(job.output)),
    }
    if still:
        made["merge.sbatch"] = MERGE.format(
            name=job.name,
            output=job.output,
            command=_words(job.command, job.merge(job.output, str(tasks))),
        )
        made["submit.sh"] += SUBMIT_MERGE
    return made


def _words(command: str, arguments: list[str]) -> str:
    """For the shell; arguments with @TASK@ are quoted, so that the value can be put in between
    quotes.
    """
    quoted = [f"'{word}'" if "@TASK@" in word else shlex.quote(word) for word in arguments]
    return " ".join([shlex.quote(command), *quoted])
