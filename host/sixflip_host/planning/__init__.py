"""What a protocol can tell apart and from which size on, and what to capture next.

protocols, plan_file              the sessions: by name, in a file, as a board is asked for them
alias, detectable                 signatures of the effects, and from which size on they show, in
                                  a plan and in captures at hand
plan_findings, plan_answer        what a plan says of each effect, what could be added, the JSON
next_capture                      what splits the effects that captures at hand leave unresolved
"""
