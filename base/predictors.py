"""What a cost model may count, named after what engines log.

A GPU predictor is either a count that belongs to a level of detail (``draw_calls`` …
``texture_bytes``), or a term of each object (``shaded_samples`` … ``untextured_triangles``), or of
the frame as a whole (``framebuffer_pixels`` … ``bytes_uploaded``).  The column order is that of
every coefficient vector in the package.
"""

LEVEL_PREDICTORS = (
    "draw_calls",  # calls to draw one instance at this level
    "vertices",
    "triangles",
    "skinned_vertices",
    "textured_triangles",
    "splats",
    "texture_bytes",
)
"""Counts that a level of detail has by itself, whatever the view."""

CHANGE_PREDICTORS = (
    "levels_changed",  # nodes drawn at another level than in the frame before
    "first_uses",  # levels drawn for the first time
    "bytes_uploaded",  # geometry at its first use, and index sets that changed, whole
)
"""Counts of what a frame draws that the frames before did not; GPU and CPU pay for them."""

GPU_PREDICTORS = (
    *LEVEL_PREDICTORS,
    "shaded_samples",  # projected area of the bounding sphere, px, summed over draws
    "triangles_in_view",  # of those drawn, how many the clipper should let through
    "rasterized_triangles",  # of those drawn, how many should reach a sample
    "reformed_objects",  # drawn where the GPU makes every level anew in every frame
    "reformed_triangles",  # triangles of these
    "untextured_triangles",  # triangles less textured ones
    "framebuffer_pixels",  # width times height
    "state_changes",  # distinct types drawn in the frame
    "reduction_steps",  # of a sum over all objects drawn, formed in pairs on the GPU
    *CHANGE_PREDICTORS,
)

POLICY_WORK = ("objects_visited", "comparisons", "iterations")
"""Counts of what a policy does to decide, which the CPU pays for."""

CPU_PREDICTORS = (
    *POLICY_WORK,
    "levels_extracted",  # index sets made, or brought to another collapse step
    "triangles_changed",  # triangles that are new or different in these
    "levels_borrowed",
    *CHANGE_PREDICTORS,
    "draw_calls",
    "objects_culled",  # nodes tested against the frustum
)
