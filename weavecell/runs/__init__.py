"""One table of runs behind every study.

A row is a shot: a set-up, its strike velocity, and which draw of all that nobody gave (`table`). Rows
are fired by any executor, each is kept by what it is made of, and a study that was ended goes on. What
is asked of the shots are functions of them: the share that passes (`passing`), the velocities that
shares pass (`go_no_go`, `v50`), and what a sweep tabulates (`sweep`).
"""
