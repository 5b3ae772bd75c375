"""Pages of studies, of the same template, style and legend as the report of a comparison."""
