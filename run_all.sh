#!/usr/bin/env bash
# Runs a whole study: simulations, tables, pictures.  See ./run_all.sh --help.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")" && pwd)

shipped() {
    local study
    for study in "$root"/studies/*.toml; do
        basename "$study" .toml
    done
}

usage() {
    cat <<END
usage: ./run_all.sh STUDY [-j N] [--out DIR] [--solver yade|reference|both]
                          [--keep all|summary|patterns] [--slice K/N] [--remake]
                          [--dry-run]

STUDY is one of:
$(shipped | paste -sd' ' | fold -s -w 80),
the path of a study file of your own (.toml; copy studies/quick.toml), or all:
every one that ships, each into DIR/STUDY, then the figures and the verdict on
the paper (hours; with YADE days).

  -j N           simulations at a time (default: one for each core, here
                 $(nproc))
  --out DIR      where everything goes (default: results/STUDY in the
                 repository)
  --solver WHAT  what simulates: reference (the built-in solver, default), yade
                 (about fifty times as long), or both
  --keep WHAT    histories: all (default), or summary: those of each point's
                 first run, and what failed; patterns: these, and what is left
                 at rest of every run
  --slice K/N    the K-th of N parts alone, without tables of the whole study: a
                 job of a cluster
  --remake       make runs again that another version of the model made (without
                 it they are kept, and named), or whose index and measures
                 another version made (without it refused where no history is
                 left)
  --dry-run      make nothing: say which runs are there, which are to be made
  -h, --help     this help

A wall file is Python and is executed: read a study's walls before you run what
someone else sent.

DIR gets runs/ (histories), tables/ (summary.csv, a row a run; points.csv, a row
a point; tables of single runs), pictures/ where the study asks for them, and
logs/.  docs/reference/studies.md describes studies. What is done is not done
again: the same command continues where an interrupted one stopped, and repeats
only what a changed study file, wall or record touches.  To have tables or
pictures made anew, delete their folder.

Exit status: 0 all done, 1 a run failed, 2 bad input, 3 software is missing, 130
interrupted.
END
}

fail() {
    printf 'error: %s\n' "$*" >&2
    exit 2
}

study='' jobs=$(nproc) out='' solver='' flags=() more=()
while [ $# -gt 0 ]; do
    case $1 in
        -h | --help)
            usage
            exit 0
            ;;
        --remake | --dry-run)
            flags+=("$1")
            shift
            ;;
        --out=* | --solver=* | --keep=* | --slice=*) set -- "${1%%=*}" "${1#*=}" "${@:2}" ;;
        -j?*) set -- -j "${1#-j}" "${@:2}" ;;
        -j | --out | --solver | --keep | --slice)
            [ -n "${2:-}" ] || fail "$1 without a value: expected one after it; see --help"
            case $1 in
                -j) jobs=$2 ;;
                --out) out=$2 ;;
                --solver) solver=$2 ;;
                *) more+=("$1" "$2") ;;
            esac
            case $1$2 in
                --keepall | --keepsummary | --keeppatterns) ;;
                --keep*) fail "--keep $2: expected all, summary or patterns; correct it" ;;
            esac
            shift 2
            ;;
        -*) fail "unknown option $1: expected -j, --out, --solver, --keep, --slice, --remake or --dry-run; see --help" ;;
        *)
            [ -z "$study" ] || fail "two studies, $study and $1: expected one; run them one after the other"
            study=$1
            shift
            ;;
    esac
done

[ -n "$study" ] || fail "no study given: expected $(shipped | paste -sd' ') or a study file; see --help"
[[ $jobs =~ ^[1-9][0-9]{0,3}$ ]] || fail "-j $jobs: expected a whole number, 1 or more; correct it"
case $solver in
    '' | yade | reference | both) ;;
    *) fail "--solver $solver: expected yade, reference or both; correct it" ;;
esac
case $study in
    all) ;;
    *.toml)
        [ -f "$study" ] || fail "$study: no such study file; correct the path"
        file=$study
        ;;
    *)
        file=$root/studies/$study.toml
        [[ $study != */* && -f $file ]] ||
            fail "no study $study is shipped: expected $(shipped | paste -sd' '), all or a study file (.toml)"
        ;;
esac

memory=$(ulimit -v)
least=$((600 + 150 * $(nproc))) # MB, as damage/memory.py has it: with less no library loads, and none seems installed
if [ "$memory" != unlimited ] && [ $((memory * 1024 / 1000000)) -lt $least ]; then
    echo "error: out of memory: ulimit -v is $((memory * 1024 / 1000000)) MB: expected $least MB or more; raise it" >&2
    exit 1
fi
# shellcheck source=scripts/environment.sh
source "$root/scripts/environment.sh" "$([[ $solver == yade || $solver == both ]] && echo run || echo reference)"
# Runs side by side are what uses the processors; threads of linear algebra would only wait on them.
export OPENBLAS_NUM_THREADS="${OPENBLAS_NUM_THREADS:-1}"

export PYTHONSAFEPATH=1 # a folder that was sent may hold a numpy.py
words=(-j "$jobs" ${out:+--out "$out"} ${solver:+--solver "$solver"} "${flags[@]}" "${more[@]}")
[ "$study" = all ] || exec "$PYTHON" -m damage study "$file" "${words[@]}"
exec "$PYTHON" -m paper studies "${words[@]}"
