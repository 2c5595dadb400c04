#!/bin/bash
# Advice on many questions by GNU parallel: one question a task, each with a store of its own, and a page of all.
# MODEL is the model, MATERIALS and RATES [Hz] what is asked of it. Frames are timed: JOBS, the tasks at a time, leaves
# cores free.
set -eu
mkdir -p advice
# Exit code 1 is an answer, too: nothing suits.
parallel --jobs "${JOBS:-50%}" hmax advise ${MODEL:---mesh phantom} --material {1} --rate {2} --jobs 1 \
  --out "advice/{1}_{2}.sqlite" '|| [ $? = 1 ]' \
  ::: ${MATERIALS:-male_slim male_normal male_fat} ::: ${RATES:-100 1000}
hmax merge advice.sqlite advice/*.sqlite
hmax report advice.sqlite --output advice.html
