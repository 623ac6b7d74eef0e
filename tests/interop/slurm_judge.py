"""A wedge that Slurm bakes is the one that --jobs bakes, to the byte; a task that is requeued changes nothing.

slurm_judge.py PROGRAM FOLDER SCENE      77: skipped, no Slurm here

Slurm is one of this test's own: its daemons, key, sockets and ports last as long as it does.
"""

import contextlib
import getpass
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

WORDS = "--method fem --triangles 100 --frames 1-4 --quality draft --formats preview --progress none --vary seed=1..4 --vary preset=copy70,copy90".split()
COUNT = 8
TIMED = {"frames.jsonl", "summary.json"}  # they say how long it took


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def configuration(folder, host, user):
    return f"""ClusterName=t
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmUser={user}
SlurmdUser={user}
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 RealMemory=500
PartitionName=p Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


@contextlib.contextmanager
def slurm():
    """One node, and what says where it is."""
    folder = Path(tempfile.mkdtemp(prefix="slurm."))
    folder.chmod(0o755)
    for name in ("state", "spool"):
        (folder / name).mkdir()
    key = folder / "munge.key"
    key.write_bytes(os.urandom(1024))
    key.chmod(0o400)
    (folder / "slurm.conf").write_text(configuration(folder, socket.gethostname().split(".")[0], getpass.getuser()))
    environment = {**os.environ, "SLURM_CONF": str(folder / "slurm.conf")}
    munged = ["munged", "--foreground", "--force", "--num-threads=2", f"--key-file={key}", f"--socket={folder}/munge.socket",
              f"--pid-file={folder}/munged.pid", f"--seed-file={folder}/munged.seed", f"--log-file={folder}/munged.log"]
    daemons = []
    try:
        with open(folder / "daemons.log", "w") as log:
            for command in (munged, ["slurmctld", "-D"], ["slurmd", "-D"]):
                daemons.append(subprocess.Popen(command, env=environment, stdout=log, stderr=log, stdin=subprocess.DEVNULL))
                time.sleep(0.5)
            if not wait(lambda: "idle" in ask(environment, "sinfo", "-h", "-o", "%t"), 60):
                sys.exit("Slurm did not start:\n" + "".join(f.read_text()[-3000:] for f in folder.glob("*.log")))
            yield environment
    finally:
        for daemon in reversed(daemons):
            daemon.terminate()
        for daemon in reversed(daemons):
            try:
                daemon.wait(20)
            except subprocess.TimeoutExpired:
                daemon.kill()
        shutil.rmtree(folder, ignore_errors=True)


def ask(environment, *command):
    return subprocess.run(command, env=environment, capture_output=True, text=True).stdout


def wait(condition, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.3)
    return False


def files(folder):
    """What an artist gets, by path."""
    return {str(f.relative_to(folder)): f for f in folder.rglob("*") if f.is_file() and ".state" not in f.parts and f.name != "wedge.sbatch"}


def main():
    program, folder, scene = sys.argv[1], Path(sys.argv[2]), sys.argv[3]
    missing = [name for name in ("sbatch", "slurmctld", "slurmd", "munged") if not shutil.which(name)]
    if missing:
        print(f"skipped: {', '.join(missing)} not installed (Debian: slurm-wlm, munge)")
        sys.exit(77)
    here, there = folder / "jobs", folder / "slurm"
    subprocess.run([program, "wedge", scene, "-o", here, *WORDS, "--jobs", "2"], check=True, stdout=subprocess.DEVNULL)
    with slurm() as environment:
        submitted = subprocess.run([program, "wedge", scene, "-o", there, *WORDS, "--submit", "slurm"], env=environment, capture_output=True, text=True)
        assert submitted.returncode == 0, submitted.stderr
        job = submitted.stdout.split()[-1]
        at_rest = lambda: not ask(environment, "squeue", "-h", "-j", job).strip()
        assert wait(at_rest, 240), ask(environment, "squeue")
        assert wait(lambda: (there / "wedge.json").exists(), 5), "the last task writes the table"

        expected, found = files(here), files(there)
        assert expected.keys() == found.keys(), expected.keys() ^ found.keys()
        assert len([name for name in found if name.endswith(".abc")]) == COUNT
        for name, file in expected.items():
            assert file.name in TIMED or file.read_bytes() == found[name].read_bytes(), f"{name} differs"

        times = {name: file.stat().st_mtime_ns for name, file in found.items()}
        log = there / ".state" / "slurm.3.log"
        log.unlink()
        subprocess.run(["scontrol", "requeue", f"{job}_3"], env=environment, check=True)
        subprocess.run(["scontrol", "update", f"jobid={job}_3", "StartTime=now"], env=environment, check=True)  # it would wait for two minutes
        assert wait(lambda: log.exists() and at_rest(), 240), "the task did not run again\n" + ask(environment, "squeue")
        assert times == {name: file.stat().st_mtime_ns for name, file in files(there).items()}, "a requeued task wrote something"
    print(f"{COUNT} variations, {len(expected)} files: Slurm and --jobs 2 agree; a requeued task changes nothing")


main()
