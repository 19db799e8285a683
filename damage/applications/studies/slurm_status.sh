#!/bin/sh
# How a job of SLURM stands, for Snakemake: success, failed or running.
#
#     slurm_status.sh JOB
#
# scontrol knows jobs for some minutes after their end; then sacct does where there is accounting.  A controller
# that does not answer says nothing about the job: it is taken to run.
found=$(scontrol show job -o "$1" 2>&1)
case $found in
    *"Invalid job id"*) state=$(sacct -X -n -P -o State -j "$1" 2>/dev/null | head -n 1) ;;
    *JobState=*) state=${found##*JobState=} ;;
    *) state=RUNNING ;;
esac
case ${state%% *} in
    COMPLETED) echo success ;;
    PENDING | CONFIGURING | RUNNING | COMPLETING | SUSPENDED | REQUEUED | RESIZING | STOPPED | SIGNALING) echo running ;;
    *) echo failed ;;
esac
