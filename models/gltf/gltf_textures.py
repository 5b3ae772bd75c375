"""What the textures of a glTF's materials take on the GPU.

Images are counted once, however many materials share them.  KTX2 is counted as the GPU holds it
(Khronos, "KHR_texture_basisu"), other images as RGBA8 with their mip chain.
"""

import io
import warnings
from collections.abc import Iterable
from typing import Any

from .gltf_accessors import Gltf, MissingBufferError
from .ktx2 import is_ktx2, ktx2_bytes

TEXEL_BYTES = 4.0 * 4.0 / 3.0
"""Of RGBA8 with its mip chain."""


class Textures:
    """The images of a document, measured when first asked for.

    Attributes
    ----------
    unmeasured : set of str
        Images that are not there or of no known format; they count nothing.
    """

    def __init__(self, gltf: Gltf) -> None:
        self._gltf = gltf
        self._bytes: dict[int, float] = {}
        self.unmeasured: set[str] = set()

    def bytes_of(self, materials: Iterable[int | None]) -> float:
        """Return bytes of the images that materials show.

        Raises `InputError` if an index is out of range, or a KTX2 header is damaged.
        """
        images: set[int] = set()
        for material in set(materials):
            images.update(self._gltf.document.images_of(material))
        return sum((self._measured(image) for image in sorted(images)), 0.0)

    def _measured(self, number: int) -> float:
        if number not in self._bytes:
            try:
                found = _size(self._gltf.image(number))
            except MissingBufferError:
                found = None
            if found is None:
                self.unmeasured.add(self._gltf.document.image_name(number))
            self._bytes[number] = found or 0.0
        return self._bytes[number]


def _size(data: bytes) -> float | None:
    """Return what an image takes on the GPU; None of no known format."""
    if is_ktx2(data):
        return ktx2_bytes(data)
    from PIL import Image

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of large images, of which the header alone is read
            image: Any = Image.open(io.BytesIO(data))
    except Exception:  # noqa: BLE001 - each of its parsers fails in its own way
        return None
    return float(image.width * image.height) * TEXEL_BYTES
