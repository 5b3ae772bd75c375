def vary(trace, seed):
    return trace
