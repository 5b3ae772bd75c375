"""Recording on a machine that nobody watches: many logs, in bounded time, none of them lost."""
