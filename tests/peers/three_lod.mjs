// Levels that three.js' LOD.update chooses: a scene and camera positions in, levels out, as JSON.
//
// in:  { objects: [{ position, distances, hysteresis }], cameras: [position], begin }
// out: [[level of each object] of each camera]; `begin` "hidden" makes all but level 0 invisible
//      before the first update, where LOD.addLevel leaves all of them visible.
import { readFileSync } from 'node:fs';
import { LOD, Object3D, PerspectiveCamera } from 'three';

const given = JSON.parse( readFileSync( 0, 'utf8' ) );
const lods = given.objects.map( ( { position, distances, hysteresis } ) => {

	const lod = new LOD();
	for ( const distance of distances ) lod.addLevel( new Object3D(), distance, hysteresis );
	if ( given.begin === 'hidden' ) lod.levels.forEach( ( level, i ) => level.object.visible = i === 0 );
	lod.position.set( ...position );
	lod.updateMatrixWorld();
	return lod;

} );
const camera = new PerspectiveCamera();
const levels = given.cameras.map( position => {

	camera.position.set( ...position );
	camera.updateMatrixWorld();
	return lods.map( lod => ( lod.update( camera ), lod.getCurrentLevel() ) );

} );
process.stdout.write( JSON.stringify( levels ) );
