#!/bin/sh
# find_python.sh VERSION...  prints the first Python of the first of these versions (e.g. 3.13) that really runs.
# A python3.13 on the PATH may be a pyenv shim that only prints an error, so each candidate is tried; it must be able to
# make a virtual environment and have the C headers that the native module needs. Exit status 1, with a reason, if none does.

try='import ensurepip, os, sys, sysconfig, venv
assert "%d.%d" % sys.version_info[:2] == sys.argv[1]
assert os.path.exists(os.path.join(sysconfig.get_paths()["include"], "Python.h"))
print(os.path.realpath(sys.executable))'

for version in "$@"; do
    for candidate in \
        $(which -a "python$version" 2>/dev/null) \
        "${PYENV_ROOT:-$HOME/.pyenv}"/versions/"$version"*/bin/"python$version" \
        "$HOME"/.local/share/uv/python/cpython-"$version"*/bin/"python$version" \
        /usr/local/bin/"python$version" /opt/python*/bin/"python$version"
    do
        [ -x "$candidate" ] || continue
        "$candidate" -c "$try" "$version" 2>/dev/null && exit 0
    done
done
echo "No Python $(echo "$*" | sed 's/ / or /g') was found that runs and has venv and C headers (Debian: python3-venv, python3-dev)." >&2
exit 1
