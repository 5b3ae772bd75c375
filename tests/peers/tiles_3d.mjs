// Tiles that 3DTilesRendererJS shows: a tileset and cameras in, tiles out, as JSON.
//
// in:  { tileset, cameras: [{ position, orientation_xyzw }], fovy_deg, width_px, height_px, near_m,
//        tolerance_px }, each content called NUMBER.glb
// out: [[numbers of the visible tiles] of each camera], once all that the camera asks for is there.
//      Contents are empty groups; volumes, errors, frustum and traversal are the peer's own.
import { readFileSync } from 'node:fs';
import { Group, PerspectiveCamera } from 'three';
import { TilesRenderer } from '3d-tiles-renderer/three';

globalThis.window = { location: { href: 'http://peer/' } };
globalThis.requestAnimationFrame = callback => setTimeout( callback, 0 );
globalThis.cancelAnimationFrame = clearTimeout;
console.warn = () => {};	// that 1.1 has limited support

const given = JSON.parse( readFileSync( 0, 'utf8' ) );

class Tiles extends TilesRenderer {

	fetchData( url ) {

		return Promise.resolve( url.endsWith( '.json' ) ? given.tileset : new ArrayBuffer( 8 ) );

	}

	async parseTile( buffer, tile ) {

		tile.engineData.scene = new Group();
		tile.engineData.geometry = tile.engineData.materials = tile.engineData.textures = [];

	}

}

const tiles = new Tiles( 'http://peer/tileset.json' );
tiles.errorTarget = given.tolerance_px;
tiles.lruCache.minSize = tiles.lruCache.maxSize = Infinity;
tiles.downloadQueue.maxJobs = tiles.parseQueue.maxJobs = tiles.maxTilesProcessed = Infinity;
const camera = new PerspectiveCamera(
	given.fovy_deg, given.width_px / given.height_px, given.near_m, 1e9
);
tiles.setCamera( camera );
tiles.setResolution( camera, given.width_px, given.height_px );

const shown = [];
for ( const { position, orientation_xyzw } of given.cameras ) {

	camera.position.set( ...position );
	camera.quaternion.set( ...orientation_xyzw );
	camera.updateMatrixWorld();
	let visible = '', quiet = 0;
	while ( quiet < 3 ) {

		tiles.update();
		await new Promise( resolve => setTimeout( resolve, 0 ) );
		const now = [ ...tiles.visibleTiles ].map( tile => parseInt( tile.content.uri.split( '/' ).pop() ) );
		const text = JSON.stringify( now.sort( ( a, b ) => a - b ) );
		quiet = text === visible && tiles.root && ! tiles.isLoading ? quiet + 1 : 0;
		visible = text;

	}
	shown.push( JSON.parse( visible ) );

}
process.stdout.write( JSON.stringify( shown ), () => process.exit( 0 ) );
