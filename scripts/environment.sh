# shellcheck shell=bash
# Finds, or installs on Debian, what the programs of this repository need.  Other scripts source it:
#
#     source scripts/environment.sh run     # YADE, a Python with the packages
#     source scripts/environment.sh reference # the same without YADE
#     source scripts/environment.sh cluster # also Snakemake
#     source scripts/environment.sh test    # also pytest with xdist and timeout, hypothesis and, where it can be had, obspy
#     source scripts/environment.sh coverage    # also coverage
#     source scripts/environment.sh browser # as site, with pytest and selenium; Chromium and its driver
#     source scripts/environment.sh app     # a Python with the packages and Flask, for python3 -m damage app
#     source scripts/environment.sh site    # a Python with the packages, Sphinx, MyST and the theme
#     source scripts/environment.sh gates   # a Python with the packages and pytest, shellcheck, ruff, mypy
#
# A machine may have another python3 first on its path, without the packages; YADE uses Debian's.  So
# the interpreter is the first of $PYTHON, /usr/bin/python3 and python3 on PATH that imports them all.
# What is missing comes from Debian's packages if this user may install them (root, or sudo without a
# password); otherwise they are named and the status is 3.  MASONRY_NO_INSTALL=1 forbids installing.
# obspy, for tests of miniSEED only, ruff and mypy come from PyPI into .venv, on top of Debian's packages.
#
# Exports PYTHON, PYTHONPATH (the repository, then what the user had in it, such as a folder with obspy), PYTHONNOUSERSITE
# and MPLBACKEND; for gates also RUFF and MYPY.  Where no Python has all packages with the user's part, it is left out.
# SYSTEM_PYTHON stands in for /usr/bin/python3 on systems that keep it elsewhere.

_env_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
_env_obspy_versions="obspy>=1.4.1"  # the latest that takes Debian's numpy
_env_tools=(ruff==0.17.6 mypy==2.4.1)  # other versions find other faults; ruff as in pyproject.toml
_env_programs=(yade)

_env_say() { printf '%s\n' "$*" >&2; }

# Names those of the modules $2... that the interpreter $1 cannot import; all for Python before 3.11.
# MPLCONFIGDIR: trying an import must leave nothing in the home folder.
_env_missing_modules() {
    local python=$1
    shift
    [ -n "$python" ] && MPLCONFIGDIR=${TMPDIR:-/tmp} "$python" -c '
import importlib, sys
for name in sys.argv[1:]:
    try:
        assert sys.version_info >= (3, 11)
        importlib.import_module(name)
    except Exception:
        print(name)
' "$@" 2>/dev/null || printf '%s\n' "$@"
}

_env_has_modules() { [ -z "$(_env_missing_modules "$@")" ]; }

# Sets PYTHON to the first interpreter that has the modules $@.
_env_find_python() {
    local candidate
    for candidate in "${PYTHON:-}" "$SYSTEM_PYTHON" python3; do
        candidate=$(type -P "$candidate" || true)
        if [ -n "$candidate" ] && _env_has_modules "$candidate" "$@"; then
            PYTHON=$candidate
            [ "${PYTHON#/}" != "$PYTHON" ] || PYTHON=$PWD/$PYTHON
            return 0
        fi
    done
    return 1
}

_env_has_programs() {
    local program
    for program in "${_env_programs[@]}"; do
        [ -n "$(type -P "$program")" ] || return 1
    done
}

# Names the Debian packages that are missing for the modules $@, and for the programs.
_env_missing_packages() {
    local module program
    for program in "${_env_programs[@]}"; do
        [ -n "$(type -P "$program")" ] || case $program in
            chromedriver) echo chromium-driver ;;
            pdftoppm) echo poppler-utils ;;
            *) echo "$program" ;;
        esac
    done
    for module in $(_env_missing_modules "$(type -P "$SYSTEM_PYTHON" || true)" "$@"); do
        case $module in
            snakemake | furo) echo "$module" ;;
            xdist) echo python3-pytest-xdist ;;
            pytest_timeout) echo python3-pytest-timeout ;;
            myst_parser) echo python3-myst-parser ;;
            *) echo "python3-$module" ;;
        esac
    done
}

_env_may_install() {
    [ -z "${MASONRY_NO_INSTALL:-}" ] && [ -n "$(type -P apt-get)" ] &&
        grep -qsE '^ID(_LIKE)?=.*debian' /etc/os-release &&
        { [ "$EUID" -eq 0 ] || sudo -n true 2>/dev/null; }
}

# Installs the Debian packages $@, with one retry; errors stay visible.
_env_install() {
    local as_root=(env DEBIAN_FRONTEND=noninteractive) attempt
    [ "$EUID" -eq 0 ] || as_root=(sudo -n "${as_root[@]}")
    _env_say "installing $*"
    for attempt in 1 2; do
        if "${as_root[@]}" apt-get -qq -o DPkg::Lock::Timeout=120 update >/dev/null &&
            "${as_root[@]}" apt-get -qq -y -o DPkg::Lock::Timeout=600 -o Dpkg::Use-Pty=0 \
                install --no-install-recommends "$@" >/dev/null; then
            return 0
        fi
        if [ "$attempt" -eq 1 ]; then
            _env_say "apt-get failed, trying once more"
            sleep 5
        fi
    done
    return 1
}

# Sets PYTHON and makes sure of the programs, for the modules $@; status 3 when that cannot be done.
_env_provide() {
    if _env_find_python "$@" && _env_has_programs; then
        return 0
    fi
    local packages
    mapfile -t packages < <(_env_missing_packages "$@")
    if [ "${#packages[@]}" -gt 0 ] && _env_may_install && _env_install "${packages[@]}"; then
        hash -r
        if _env_find_python "$@" && _env_has_programs; then
            return 0
        fi
        mapfile -t packages < <(_env_missing_packages "$@")
    fi
    _env_say "error: missing on this machine: ${packages[*]}"
    _env_say "get them with: sudo apt-get update && sudo apt-get install --no-install-recommends ${packages[*]}"
    return 3
}

# Prints the constraints that keep Debian's packages in use: their versions as they are, for pip.
_env_constraints() {
    "$PYTHON" -c '
import importlib, sys
for name in sys.argv[1:]:
    print(f"{name}=={importlib.import_module(name).__version__}")
' numpy scipy pandas h5py matplotlib numba
}

# Adds $2, of the versions $3, to the environment $1 on top of the packages of $PYTHON, or says why not (status 1).
_env_add_to_venv() {
    local venv=$1 name=$2 versions=$3 constraints output
    if [ -n "${MASONRY_NO_INSTALL:-}" ]; then
        _env_say "$name is missing and MASONRY_NO_INSTALL is set"
        return 1
    fi
    if [ -e "$venv" ] && ! grep -qs '^include-system-site-packages = true' "$venv/pyvenv.cfg"; then
        _env_say "$name is missing; .venv is not of this script's making and is left alone"
        return 1
    fi
    if ! "$PYTHON" -c 'import ensurepip' 2>/dev/null && _env_may_install; then
        _env_install python3-venv || true
    fi
    _env_say "installing $name into .venv"
    constraints=$(mktemp) || return 1
    if _env_constraints >"$constraints" &&
        output=$("$PYTHON" -m venv --system-site-packages "$venv" 2>&1) &&
        output=$("$venv/bin/python" -m pip install --quiet --only-binary :all: --retries 1 --timeout 20 \
            --constraint "$constraints" "$versions" 2>&1) &&
        [ -z "$(compgen -G "$venv/lib/python3*/site-packages/numpy")" ]; then
        rm -f "$constraints"
        return 0
    fi
    rm -f "$constraints"
    _env_say "$name could not be installed: $(tail -n 1 <<<"${output:-unknown reason}")"
    return 1
}

# Sets PYTHON to .venv's interpreter when obspy can be had; the modules $@ must be there, too.
_env_add_obspy() {
    local venv=$_env_root/.venv
    if _env_has_modules "$PYTHON" obspy; then
        return 0
    fi
    if _env_has_modules "$venv/bin/python" obspy "$@" ||
        { _env_add_to_venv "$venv" obspy "$_env_obspy_versions" && _env_has_modules "$venv/bin/python" obspy "$@"; }; then
        PYTHON=$venv/bin/python
    else
        _env_say "tests of miniSEED are skipped: they need obspy"
    fi
}

# Sets RUFF and MYPY to .venv's programs of the fixed versions; status 3 when one cannot be had.
_env_find_tools() {
    local tool path
    for tool in "${_env_tools[@]}"; do
        path=$_env_root/.venv/bin/${tool%==*}
        _env_is_version "$path" "$tool" || _env_add_to_venv "$_env_root/.venv" "${tool%==*}" "$tool" || true
        if ! _env_is_version "$path" "$tool"; then
            _env_say "error: missing on this machine: $tool"
            return 3
        fi
    done
    export RUFF=$_env_root/.venv/bin/ruff MYPY=$_env_root/.venv/bin/mypy
}

# Whether the program at $1 prints that it is $2, NAME==VERSION.
_env_is_version() { [[ "$("$1" --version 2>/dev/null) " = "${2/==/ } "* ]]; }

# Puts the repository before what the user has in PYTHONPATH, whose relative folders are those of the working folder.
_env_set_path() {
    local given folder path=$_env_root
    IFS=: read -r -a given <<<"${PYTHONPATH:-}"
    for folder in "${given[@]}"; do
        [ "${folder#/}" != "$folder" ] || folder=${folder:+$PWD/$folder}
        case ":$path:" in *":$folder:"*) ;; *) path+=${folder:+:$folder} ;; esac
    done
    export PYTHONPATH=$path
}

# Leaves the user's part of PYTHONPATH out where it alone keeps every Python from importing the modules $@.
_env_leave_out_what_breaks() {
    local whole=$PYTHONPATH
    if [ "$whole" = "$_env_root" ] || _env_find_python "$@"; then
        return 0
    fi
    PYTHONPATH=$_env_root
    if _env_find_python "$@"; then
        _env_say "warning: ${whole#"$_env_root:"} is left out of PYTHONPATH: with it no Python has all packages"
    else
        PYTHONPATH=$whole
    fi
}

_env_main() {
    local -x PYTHONSAFEPATH=1 # the working folder may hold a numpy.py that someone sent
    local modules=(numpy scipy pandas h5py matplotlib numba jinja2)
    case ${1:-run} in
        run) ;;
        reference) _env_programs=() ;;
        cluster) modules+=(snakemake) ;;
        test) modules+=(snakemake pytest xdist pytest_timeout hypothesis flask) ;;
        coverage) modules+=(snakemake pytest xdist hypothesis flask coverage) ;;
        app)
            modules+=(flask)
            _env_programs=()
            ;;
        browser)
            modules+=(pytest hypothesis selenium sphinx myst_parser furo flask)
            _env_programs=(chromium chromedriver pdftoppm)
            ;;
        site)
            modules+=(sphinx myst_parser furo)
            _env_programs=()
            ;;
        gates)
            modules+=(pytest)
            _env_programs=(shellcheck)
            ;;
        *)
            _env_say "error: environment.sh $1: expected run, reference, cluster, test, coverage, browser, app, site or gates; correct the call"
            return 2
            ;;
    esac
    : "${SYSTEM_PYTHON:=/usr/bin/python3}"
    unset PYTHONHOME
    export PYTHONNOUSERSITE=1 MPLBACKEND=Agg
    _env_set_path
    _env_leave_out_what_breaks "${modules[@]}"
    _env_provide "${modules[@]}" || return
    case ${1:-run} in
        test | coverage) _env_add_obspy "${modules[@]}" ;;
        gates) _env_find_tools || return ;;
    esac
    export PYTHON
}

_env_main "$@" || return
